# Compiler flags of all of snell's own code.
add_library(snell_flags INTERFACE)

# -ffp-contract=off: the same picture on every instruction set. -fno-math-errno: sqrt without a branch and a call.
target_compile_options(snell_flags INTERFACE -ffp-contract=off -fno-math-errno -fno-trapping-math
    -Wall -Wextra -Wconversion -Wshadow -Wno-psabi
    -Wno-restrict) # GCC 12 sees overlaps where strings are joined (its bug 105651)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(snell_flags INTERFACE -Wno-restrict) # false alarms on std::string, GCC's bug 105651
endif()
if(SNELL_WARNINGS_AS_ERRORS)
    target_compile_options(snell_flags INTERFACE -Werror)
endif()

if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    target_compile_options(snell_flags INTERFACE -march=x86-64-v2)
endif()

set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")
set(CMAKE_CXX_FLAGS_DEBUG "-Og -g")
# Line numbers only: full debug information doubles the time to build.
set(CMAKE_CXX_FLAGS_SANITIZER "-O1 -g1 -D_GLIBCXX_ASSERTIONS")

if(SNELL_SANITIZE)
    target_compile_options(snell_flags INTERFACE
        -fsanitize=${SNELL_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(snell_flags INTERFACE -fsanitize=${SNELL_SANITIZE})
    # Highway's own checks, which it has on under sanitizers, double the time that the traversal takes to compile.
    target_compile_definitions(snell_flags INTERFACE HWY_IS_DEBUG_BUILD=0)
endif()
