# The revision of the sources, written at each build and compiled into one small library, so
# that every file a stage writes can say which sources made it.
set(RUNCERT_REVISION_SOURCE ${CMAKE_BINARY_DIR}/source_revision.cpp)
add_custom_target(runcert_revision_file
  COMMAND ${CMAKE_COMMAND} -DSOURCE_DIR=${CMAKE_SOURCE_DIR} -DOUTPUT=${RUNCERT_REVISION_SOURCE}
          -DVERSION=${PROJECT_VERSION} -P ${CMAKE_SOURCE_DIR}/cmake/WriteSourceRevision.cmake
  BYPRODUCTS ${RUNCERT_REVISION_SOURCE}
  COMMENT "" VERBATIM)
