find_package(ament_cmake_test QUIET REQUIRED)
include("${ament_cmake_as2fm_DIR}/ament_as2fm.cmake")
ament_register_extension("ament_lint_auto" "ament_cmake_as2fm" "ament_cmake_as2fm_lint_hook.cmake")
