# Writes ADD_TEST lines, one for each suite of a GoogleTest program: its tests then run in one
# process and share what the suite sets up.
#   cmake -DPROGRAM=... -DNAME=... -DPROPERTIES=... -DOUT=... -P suites.cmake
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed
  RESULT_VARIABLE status TIMEOUT 60)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${NAME} does not list its tests (${status})")
endif()
string(REGEX MATCHALL "(^|\n)[A-Za-z0-9_/]+\\." suites "${listed}")
set(text)
foreach(suite ${suites})
  string(REGEX REPLACE "[\n.]" "" suite "${suite}")
  string(APPEND text "add_test([=[${NAME}.${suite}]=] [=[${PROGRAM}]=] [=[--gtest_filter=${suite}.*]=])\n")
  if(PROPERTIES)
    string(REPLACE " " ";" properties "${PROPERTIES}")
    string(APPEND text "set_tests_properties([=[${NAME}.${suite}]=] PROPERTIES")
    foreach(word ${properties})
      string(APPEND text " [=[${word}]=]")
    endforeach()
    string(APPEND text ")\n")
  endif()
endforeach()
file(WRITE ${OUT} "${text}")
