# Installs into a folder of its own, builds a project that finds the package there, and runs it.
add_test(NAME Consumer.FindsTheInstalledPackage
         COMMAND ${CMAKE_COMMAND} -DBUILD=${PROJECT_BINARY_DIR} -DCONFIG=$<CONFIG>
                 -DSOURCE=${CMAKE_CURRENT_LIST_DIR} -DWORK=${CMAKE_CURRENT_BINARY_DIR}/consumer
                 -DGENERATOR=${CMAKE_GENERATOR} -DCOMPILER=${CMAKE_CXX_COMPILER}
                 -P ${CMAKE_CURRENT_LIST_DIR}/install_and_build.cmake)
set_tests_properties(Consumer.FindsTheInstalledPackage PROPERTIES LABELS heavy TIMEOUT 300)
