# With ament_lint_auto, every package that contains models is checked.
file(GLOB_RECURSE as2fm_models FOLLOW_SYMLINKS "*.ascxml" "*.scxml")
if(as2fm_models)
  message(STATUS "Added test 'as2fm' to check the models")
  ament_as2fm()
endif()
