# snell_add_test_program(NAME SOURCE...): a GoogleTest program that ctest runs under that name and label, in an
# environment of its own: a folder for temporary files, and a report of its cases that ./test counts.
function(snell_add_test_program name)
    add_executable(test_${name} ${ARGN})
    target_link_libraries(test_${name} PRIVATE libsnell snell_flags GTest::gtest GTest::gtest_main)
    target_compile_definitions(test_${name} PRIVATE SNELL_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    # What is tested is the library; the tests themselves compile in two thirds of the time like this.
    target_compile_options(test_${name} PRIVATE -O1)
    set(scratch ${PROJECT_BINARY_DIR}/scratch/${name})
    file(MAKE_DIRECTORY ${scratch})
    add_test(NAME ${name} COMMAND test_${name})
    set_tests_properties(${name} PROPERTIES
        LABELS ${name}
        TIMEOUT 1500
        ENVIRONMENT "TMPDIR=${scratch};TEST_TMPDIR=${scratch};GTEST_OUTPUT=xml:${PROJECT_BINARY_DIR}/results/${name}.xml")
endfunction()
