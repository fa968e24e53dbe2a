# The GPU backend: snell/vulkan/ and its kernels, which glslc compiles to SPIR-V that becomes part of the library. A build
# without libvulkan-dev or glslc has snell/vulkan/absent.cpp instead, which says so where a GPU is asked for.
set(SNELL_HAS_VULKAN OFF)
if(SNELL_VULKAN)
    set(how REQUIRED)
    if(SNELL_VULKAN STREQUAL "AUTO")
        set(how QUIET)
    endif()
    find_package(Vulkan ${how} COMPONENTS glslc)
    if(Vulkan_FOUND AND Vulkan_glslc_FOUND)
        set(SNELL_HAS_VULKAN ON)
    else()
        message(STATUS "The GPU backend is left out: install libvulkan-dev and glslc for it")
    endif()
endif()

if(NOT SNELL_HAS_VULKAN)
    target_sources(libsnell PRIVATE snell/vulkan/absent.cpp)
    return()
endif()

file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/snell/vulkan/*.cpp)
list(FILTER sources EXCLUDE REGEX "absent\\.cpp$")
target_sources(libsnell PRIVATE ${sources})
target_link_libraries(libsnell PUBLIC Vulkan::Vulkan)
find_package(SPIRV-Tools QUIET)
find_package(SPIRV-Tools-opt QUIET)
if(SPIRV-Tools-opt_FOUND)
    target_link_libraries(libsnell PRIVATE SPIRV-Tools-opt)
    set_source_files_properties(${PROJECT_SOURCE_DIR}/snell/vulkan/specialise.cpp PROPERTIES
        COMPILE_DEFINITIONS SNELL_HAS_SPIRV_OPT)
else()
    message(STATUS "GPU kernels start more slowly: install spirv-tools to have them cut to the scene")
endif()

# Not optimised by glslc: its optimiser (2023.2) makes invalid SPIR-V of structs that hold addresses, and drivers optimise
# anyway. Each .comp file becomes an array of words, and all of them one table: name, code.
set(generated ${PROJECT_BINARY_DIR}/vulkan)
file(MAKE_DIRECTORY ${generated})
file(GLOB kernels CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/snell/vulkan/shaders/*.comp)
set(arrays "")
set(table "")
set(codes)
foreach(kernel ${kernels})
    get_filename_component(name ${kernel} NAME_WE)
    add_custom_command(
        OUTPUT ${generated}/${name}.inc
        COMMAND Vulkan::glslc --target-env=vulkan1.2 -Werror -mfmt=c -I ${PROJECT_SOURCE_DIR}
            -MD -MF ${generated}/${name}.d -MT ${generated}/${name}.inc -o ${generated}/${name}.inc ${kernel}
        DEPENDS ${kernel}
        DEPFILE ${generated}/${name}.d
        COMMENT "GLSL ${name}"
        VERBATIM)
    list(APPEND codes ${generated}/${name}.inc)
    string(APPEND arrays "constexpr std::uint32_t code_${name}[] =\n#include \"${name}.inc\"\n    ;\n")
    string(APPEND table "    {\"${name}\", code_${name}},\n")
endforeach()
file(CONFIGURE OUTPUT ${generated}/snell_vulkan_kernels.inc @ONLY CONTENT
    "${arrays}constexpr Kernel kernels[] = {\n${table}};\n")
set_source_files_properties(${PROJECT_SOURCE_DIR}/snell/vulkan/pipelines.cpp PROPERTIES
    INCLUDE_DIRECTORIES ${generated} OBJECT_DEPENDS "${codes}")
