# Adds a test that checks models with as2fm-lsp. The findings are in the test's JUnit file.
#
# ament_as2fm([TESTNAME name] [ROS_PATH folder ...] [OPTIONS option ...] [path ...])
#
# The paths are systems, files and folders; by default, the folder of the package. ROS_PATH lists folders with interface
# packages in addition to those of AMENT_PREFIX_PATH. OPTIONS are further options of `as2fm-lsp check`.
function(ament_as2fm)
  cmake_parse_arguments(ARG "" "TESTNAME" "ROS_PATH;OPTIONS" ${ARGN})
  if(NOT ARG_TESTNAME)
    set(ARG_TESTNAME "as2fm")
  endif()
  if(NOT ARG_UNPARSED_ARGUMENTS)
    set(ARG_UNPARSED_ARGUMENTS "${CMAKE_CURRENT_SOURCE_DIR}")
  endif()
  find_program(as2fm_lsp_BIN NAMES "as2fm-lsp")
  if(NOT as2fm_lsp_BIN)
    message(FATAL_ERROR "ament_as2fm() could not find the program 'as2fm-lsp'; install it with 'rosdep' or 'pip'")
  endif()
  set(command "${as2fm_lsp_BIN}" "check" ${ARG_UNPARSED_ARGUMENTS})
  foreach(folder ${ARG_ROS_PATH})
    list(APPEND command "--ros-path" "${folder}")
  endforeach()
  set(result_file "${AMENT_TEST_RESULTS_DIR}/${PROJECT_NAME}/${ARG_TESTNAME}.xunit.xml")
  list(APPEND command ${ARG_OPTIONS} "--format" "junit" "--output" "${result_file}")
  file(MAKE_DIRECTORY "${CMAKE_BINARY_DIR}/ament_as2fm")
  ament_add_test(
    "${ARG_TESTNAME}"
    COMMAND ${command}
    OUTPUT_FILE "${CMAKE_BINARY_DIR}/ament_as2fm/${ARG_TESTNAME}.txt"
    RESULT_FILE "${result_file}"
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
  )
  set_tests_properties("${ARG_TESTNAME}" PROPERTIES LABELS "as2fm;linter")
endfunction()
