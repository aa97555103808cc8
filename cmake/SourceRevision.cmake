# The revision of the sources, written at each build and compiled into one small library, so
# that every file a stage writes can say which sources made it.
set(RUNCERT_HOME_URL "" CACHE STRING
  "Where this program is to be had, set by whoever builds it: bundles and reports say it")
if(NOT RUNCERT_HOME_URL MATCHES "^(https?://[A-Za-z0-9._~:/?#@!&'()*+,=%-]+)?$")
  message(FATAL_ERROR "RUNCERT_HOME_URL is no address of the web: ${RUNCERT_HOME_URL}")
endif()
set(RUNCERT_REVISION_SOURCE ${CMAKE_BINARY_DIR}/source_revision.cpp)
add_custom_target(runcert_revision_file
  COMMAND ${CMAKE_COMMAND} -DSOURCE_DIR=${CMAKE_SOURCE_DIR} -DOUTPUT=${RUNCERT_REVISION_SOURCE}
          -DVERSION=${PROJECT_VERSION} -DHOME_URL=${RUNCERT_HOME_URL} -P ${CMAKE_SOURCE_DIR}/cmake/WriteSourceRevision.cmake
  BYPRODUCTS ${RUNCERT_REVISION_SOURCE}
  COMMENT "" VERBATIM)
