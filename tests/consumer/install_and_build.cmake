# cmake -P: what a user does after building the project. BUILD, CONFIG, SOURCE, WORK, GENERATOR and
# COMPILER are given.
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --config ${CONFIG} --prefix ${WORK}/prefix)
foreach(file bin/sdfgrid include/sdfgrid/grid/grid.h)
  if(NOT EXISTS ${WORK}/prefix/${file})
    message(FATAL_ERROR "not installed: ${file}")
  endif()
endforeach()
foreach(file include/sdfgrid/core/simd.h)
  if(EXISTS ${WORK}/prefix/${file})
    message(FATAL_ERROR "installed, but private: ${file}")
  endif()
endforeach()
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G ${GENERATOR}
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_PREFIX_PATH=${WORK}/prefix)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${CMAKE_COMMAND} -E chdir ${WORK}/build ${WORK}/build/consumer)
# The installed program finds its module for pictures wherever the prefix is.
run(${WORK}/prefix/bin/sdfgrid render ${WORK}/build/consumer.vdb -o ${WORK}/build/tetrahedron.png
    --size 16x16 --quiet)
