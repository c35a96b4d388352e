# Runs the creature program: exit codes, files left behind, same bytes every time. Needs CREATURE (program), WORK (folder).

function(expect_exit_code expected)
  execute_process(COMMAND ${CREATURE} ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(NOT code STREQUAL expected)
    message(FATAL_ERROR "creature ${ARGN}: exit code ${code}, not ${expected}\n${out}${err}")
  endif()
endfunction()

function(expect_files folder)
  file(GLOB found RELATIVE ${folder} ${folder}/*)
  list(SORT found)
  if(NOT "${found}" STREQUAL "${ARGN}")
    message(FATAL_ERROR "${folder} holds '${found}', not '${ARGN}'")
  endif()
endfunction()

set(poses creature_curl.ply creature_leap.ply creature_reach.ply creature_rest.ply creature_twist.ply)
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK}/a ${WORK}/b ${WORK}/blocked/creature_curl.ply)

expect_exit_code(0 --help)
expect_exit_code(2)
expect_exit_code(2 -o)
expect_exit_code(2 -o ${WORK}/a --vertices 7999)
expect_exit_code(2 -o ${WORK}/a --vertices 9000x)
expect_exit_code(2 -o ${WORK}/a surplus)
expect_files(${WORK}/a)

expect_exit_code(1 -o ${WORK}/missing --vertices 8000)

# A folder stands where the third file is to be written: none of the other four may appear.
expect_exit_code(1 -o ${WORK}/blocked --vertices 8000)
expect_files(${WORK}/blocked creature_curl.ply)

# Files of at most 4 KiB, then a full disk behind standard output: an error, no signal, no file left.
if(EXISTS /dev/full)
  set(program ${CREATURE})
  set(CREATURE sh -c "ulimit -f 8 && exec \"$@\"" sh ${program})
  expect_exit_code(1 -o ${WORK}/a --vertices 8000)
  expect_files(${WORK}/a)
  set(CREATURE sh -c "exec \"$@\" > /dev/full" sh ${program})
  expect_exit_code(1 --help)
  set(CREATURE ${program})
endif()

expect_exit_code(0 -o ${WORK}/a --vertices 8000)
expect_exit_code(0 --vertices 8000 --output ${WORK}/b)
expect_files(${WORK}/a ${poses})
foreach(pose IN LISTS poses)
  file(SHA256 ${WORK}/a/${pose} first)
  file(SHA256 ${WORK}/b/${pose} second)
  if(NOT first STREQUAL second)
    message(FATAL_ERROR "${pose} differs between two runs")
  endif()
endforeach()
file(REMOVE_RECURSE ${WORK})
