# How does a build bake its assets? A rule for each, made again when the asset, its buffers, its textures or the program
# change:
#
#     hemibake_bake(TARGET room INPUT room.glb OUTPUT room.baked.glb
#       [OPTIONS --quality high ...]     as 'hemibake bake --help' lists them
#       [REPORT room.json]
#       [DEPENDS file ...]               what else it must be made again for
#       [ALL])                           part of the default build
#
# INPUT is relative to the current source folder; OUTPUT and REPORT to the current binary folder. TARGET may be named by many
# calls: it then stands for all their outputs.
#
#     HEMIBAKE_JOBS     bakes at once under Ninja; default: as many as there are cores
#     HEMIBAKE_THREADS  threads of each; default: the cores divided by the jobs
#
# Many bakes of one thread finish sooner than one after the other with many; the bytes are the same either way. Make has no
# pools: there, -j says how many.

# The pool is a global property, so it is set once for the whole build.
function(_hemibake_set_up)
  get_property(done GLOBAL PROPERTY HEMIBAKE_SET_UP)
  if(done)
    return()
  endif()
  cmake_host_system_information(RESULT cores QUERY NUMBER_OF_LOGICAL_CORES)
  set(HEMIBAKE_JOBS ${cores} CACHE STRING "Bakes at once under Ninja")
  math(EXPR threads "${cores} / ${HEMIBAKE_JOBS}")
  if(threads LESS 1)
    set(threads 1)
  endif()
  set(HEMIBAKE_THREADS ${threads} CACHE STRING "Threads of each bake")
  set_property(GLOBAL APPEND PROPERTY JOB_POOLS hemibake=${HEMIBAKE_JOBS})
  set_property(GLOBAL PROPERTY HEMIBAKE_SET_UP ON)
endfunction()

# All outputs of a target, which may have been named before.
function(_hemibake_add_to_target target output in_all)
  if(TARGET ${target})
    get_target_property(bake ${target} HEMIBAKE_BAKE)
    if(NOT bake)
      message(FATAL_ERROR "hemibake_bake: TARGET '${target}' is taken by something that is no bake; choose another name")
    endif()
  else()
    add_custom_target(${target} ${in_all})
    set_target_properties(${target} PROPERTIES HEMIBAKE_BAKE ON)
  endif()
  # A custom target takes further files only through another one.
  string(SHA1 key ${output})
  string(SUBSTRING ${key} 0 10 key)
  add_custom_target(${target}.${key} DEPENDS ${output})
  add_dependencies(${target} ${target}.${key})
endfunction()

function(hemibake_bake)
  cmake_parse_arguments(PARSE_ARGV 0 BAKE "ALL" "TARGET;INPUT;OUTPUT;REPORT" "OPTIONS;DEPENDS")
  foreach(needed TARGET INPUT OUTPUT)
    if(NOT BAKE_${needed})
      message(FATAL_ERROR "hemibake_bake: ${needed} is missing; it takes TARGET, INPUT and OUTPUT")
    endif()
  endforeach()
  if(BAKE_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "hemibake_bake: '${BAKE_UNPARSED_ARGUMENTS}' is not an argument; options follow OPTIONS")
  endif()
  _hemibake_set_up()

  cmake_path(ABSOLUTE_PATH BAKE_INPUT BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE OUTPUT_VARIABLE input)
  cmake_path(ABSOLUTE_PATH BAKE_OUTPUT BASE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR} NORMALIZE OUTPUT_VARIABLE output)
  set(outputs ${output})
  if(output MATCHES "\\.[gG][lL][tT][fF]$")
    string(REGEX REPLACE "\\.[^.]*$" ".bin" bin ${output})
    list(APPEND outputs ${bin})
  endif()
  set(arguments ${BAKE_OPTIONS})
  if(NOT "--threads" IN_LIST arguments)
    list(APPEND arguments --threads ${HEMIBAKE_THREADS})
  endif()
  if(BAKE_REPORT)
    cmake_path(ABSOLUTE_PATH BAKE_REPORT BASE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR} NORMALIZE OUTPUT_VARIABLE report)
    list(APPEND outputs ${report})
    list(APPEND arguments --report ${report})
  endif()

  cmake_path(GET output PARENT_PATH folder)
  file(MAKE_DIRECTORY ${folder})
  cmake_path(GET output FILENAME name)
  add_custom_command(OUTPUT ${outputs}
    COMMAND hemibake::cli bake ${input} -o ${output} --quiet --depfile ${output}.d ${arguments}
    DEPENDS ${input} ${BAKE_DEPENDS} hemibake::cli
    DEPFILE ${output}.d
    COMMENT "Baking ${name}" JOB_POOL hemibake VERBATIM)
  set(in_all)
  if(BAKE_ALL)
    set(in_all ALL)
  endif()
  _hemibake_add_to_target(${BAKE_TARGET} ${output} "${in_all}")
endfunction()
