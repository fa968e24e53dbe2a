# Copies the header FROM to TO with TEXT replaced by SPOILT.
file(READ ${FROM} content)
string(FIND "${content}" "${TEXT}" at)
if(at EQUAL -1)
    message(FATAL_ERROR "${FROM} no longer contains \"${TEXT}\": give this mutant another text in "
        "tests/gpu/CMakeLists.txt")
endif()
string(REPLACE "${TEXT}" "${SPOILT}" content "${content}")
file(WRITE ${TO} "${content}")
