# The commit hash lives in one tiny file of the build folder, looked up at each build and rewritten only when it has
# changed: a commit costs one small compilation, not a full one. Run as a script, this file writes it.
if(CMAKE_SCRIPT_MODE_FILE)
    cmake_minimum_required(VERSION 3.25)
    set(commit "unknown")
    if(EXISTS ${SOURCE}/.git)
        execute_process(COMMAND git -C ${SOURCE} describe --always --dirty=-modified --abbrev=10
            OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE result)
        if(result EQUAL 0)
            set(commit ${described})
        endif()
    endif()
    file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT
        "namespace snell {\nextern const char* const built_commit;\nconst char* const built_commit = \"@commit@\";\n}\n")
    return()
endif()

function(snell_add_version target)
    set(generated ${PROJECT_BINARY_DIR}/version_commit.cpp)
    add_custom_target(snell_commit BYPRODUCTS ${generated} VERBATIM
        COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR} -DOUTPUT=${generated}
            -P ${PROJECT_SOURCE_DIR}/cmake/version.cmake
        COMMENT "")
    target_sources(${target} PRIVATE ${generated})
    add_dependencies(${target} snell_commit)
    set_source_files_properties(${PROJECT_SOURCE_DIR}/snell/core/version.cpp PROPERTIES
        COMPILE_DEFINITIONS "SNELL_VERSION=\"${PROJECT_VERSION}\"")
endfunction()
