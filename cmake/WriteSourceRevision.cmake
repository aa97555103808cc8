cmake_minimum_required(VERSION 3.25)

# Writes OUTPUT only where its text changes. Outside a git checkout the revision is "unknown".
execute_process(COMMAND git -C ${SOURCE_DIR} -c safe.directory=* rev-parse --short=12 HEAD
  OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE status ERROR_QUIET)
if(NOT status EQUAL 0)
  set(revision "unknown")
else()
  execute_process(COMMAND git -C ${SOURCE_DIR} -c safe.directory=* status --porcelain --untracked-files=no
    OUTPUT_VARIABLE changed ERROR_QUIET)
  if(changed)
    string(APPEND revision "-modified")
  endif()
endif()
execute_process(COMMAND git -C ${SOURCE_DIR} -c safe.directory=* log -1 --format=%ct
  OUTPUT_VARIABLE seconds OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT seconds MATCHES "^[0-9]+$")
  set(seconds 0)
endif()
set(ENV{SOURCE_DATE_EPOCH} ${seconds})
string(TIMESTAMP time UTC)
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT
"#include \"store/program.h\"
namespace runcert {
const char* program_version() { return \"@VERSION@\"; }
const char* source_revision() { return \"@revision@\"; }
const char* source_time() { return \"@time@\"; }
const char* program_home() { return \"@HOME_URL@\"; }
}  // namespace runcert
")
