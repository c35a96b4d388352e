# pliant_bake(OUTPUT <asset> POSES <pose>... [OPTIONS <option>...] [NAME <target>] [DEPENDS <file or target>...])
# pliant_bake(OUTPUT <asset> CONFIG <file.json> [OPTIONS <option>...] [NAME <target>] [DEPENDS <file or target>...])
#
# A rule that bakes an asset with `pliant bake`, and a target for it that is built with ALL (named after the asset unless
# NAME is given). The asset is baked again when a file that the last bake has read is newer: poses, what glTF files name,
# --fix, --surface, the configuration; and when the tool is. Poses may have a choice, then in quotes, since '#' begins a
# comment: POSES "hero.glb" "hero.glb#target=smile". Relative poses and configurations are in the source folder, a
# relative OUTPUT in the binary folder; paths in OPTIONS should be absolute. DEPENDS is for inputs that other rules of the
# project make. OPTIONS are those of the command line: OPTIONS --tolerance-max 0.01 --seed 7. Needs the Ninja or a
# Makefile generator (DEPFILE). Paths of the project and of the files that the bake reads must not have characters that
# dependency files cannot express, such as '=', '%', '[' or a quote (P4604). With Ninja neither '#' nor '$': CMake (3.25)
# does not escape them there, and the asset is baked at every build. With Makefiles CMake (3.25) never forgets a file of a
# dependency file: when one is removed or renamed, delete compiler_depend.* below CMakeFiles/ in the build folder, or the
# asset is baked at every build.
cmake_policy(PUSH)
cmake_policy(VERSION 3.20...3.25) # 3.20: dependency files of both generators, paths in them as they are meant

function(pliant_bake)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "OUTPUT;CONFIG;NAME" "POSES;OPTIONS;DEPENDS")
  if(NOT arg_OUTPUT OR arg_UNPARSED_ARGUMENTS OR (arg_CONFIG AND arg_POSES) OR NOT (arg_CONFIG OR arg_POSES))
    message(FATAL_ERROR "pliant_bake: needs OUTPUT and either POSES or CONFIG; does not know '${arg_UNPARSED_ARGUMENTS}'")
  endif()
  cmake_path(ABSOLUTE_PATH arg_OUTPUT BASE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR} NORMALIZE)
  cmake_path(GET arg_OUTPUT PARENT_PATH folder)
  file(MAKE_DIRECTORY ${folder})
  set(poses)
  set(inputs)
  foreach(pose IN LISTS arg_POSES)
    string(REGEX REPLACE "(\\.([gG][lL]([bB]|[tT][fF])|[vV][rR][mM]))#.*" "\\1" file "${pose}")
    string(LENGTH "${file}" length)
    string(SUBSTRING "${pose}" ${length} -1 choice)
    cmake_path(ABSOLUTE_PATH file BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
    list(APPEND poses "${file}${choice}")
    list(APPEND inputs "${file}")
  endforeach()
  set(config)
  if(arg_CONFIG)
    cmake_path(ABSOLUTE_PATH arg_CONFIG BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
    set(config --config ${arg_CONFIG})
    list(APPEND inputs ${arg_CONFIG})
  endif()
  cmake_path(RELATIVE_PATH arg_OUTPUT BASE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR} OUTPUT_VARIABLE shown)
  if(NOT arg_NAME)
    string(MAKE_C_IDENTIFIER ${shown} arg_NAME)
  endif()
  add_custom_command(OUTPUT ${arg_OUTPUT}
    COMMAND pliant::tool bake ${config} ${arg_OPTIONS} --quiet -o ${arg_OUTPUT} --depfile ${arg_OUTPUT}.d -- ${poses}
    DEPENDS ${inputs} ${arg_DEPENDS} $<TARGET_FILE:pliant::tool>
    DEPFILE ${arg_OUTPUT}.d
    COMMENT "Baking ${shown}"
    VERBATIM)
  add_custom_target(${arg_NAME} ALL DEPENDS ${arg_OUTPUT})
endfunction()

cmake_policy(POP)
