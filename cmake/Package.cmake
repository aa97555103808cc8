# What is installed where, and the Debian package made of it (`runcert package`).
#
# The programs lie side by side, since runcert starts the others from its own folder; the path has
# a link to runcert alone.
include(GNUInstallDirs)

set(RUNCERT_MAINTAINER "runcert packagers <packagers@runcert.invalid>" CACHE STRING
  "Who answers for the package: NAME <ADDRESS>, set by whoever builds it")

set(programs_dir ${CMAKE_INSTALL_LIBEXECDIR}/runcert)
install(TARGETS ${RUNCERT_PROGRAMS} RUNTIME DESTINATION ${programs_dir})
file(RELATIVE_PATH to_runcert ${CMAKE_INSTALL_FULL_BINDIR}
  ${CMAKE_INSTALL_PREFIX}/${programs_dir}/runcert)
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/package)
file(CREATE_LINK ${to_runcert} ${CMAKE_BINARY_DIR}/package/runcert SYMBOLIC)
install(FILES ${CMAKE_BINARY_DIR}/package/runcert DESTINATION ${CMAKE_INSTALL_BINDIR})

# Pages of the manual and completion say what --help says: they are made of it. Dates are those of
# the sources, so that the same sources give the same package.
set(derived ${CMAKE_BINARY_DIR}/package/derived)
add_custom_target(package_derived
  COMMAND ${CMAKE_SOURCE_DIR}/cmake/package/derive $<TARGET_FILE:runcert> ${CMAKE_SOURCE_DIR} ${derived}
    ${RUNCERT_MAINTAINER}
  DEPENDS runcert_programs VERBATIM)
install(DIRECTORY ${derived}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} OPTIONAL)
install(FILES ${derived}/completion RENAME runcert OPTIONAL
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${derived}/changelog.gz DESTINATION ${CMAKE_INSTALL_DOCDIR} OPTIONAL)

install(FILES README.md REFERENCES.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES cmake/package/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
foreach(page reports/METHOD.md stages/import/README.md stages/check/profiles/README.md
    pipeline/outer/days/README.md pipeline/trust/README.md pipeline/trust/ATTESTING.md pipeline/trust/CHECKING.md pipeline/trust/KEEPING.md
    reports/WORDS.md schemas/README.md)
  get_filename_component(folder ${page} DIRECTORY)
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder})
endforeach()
install(DIRECTORY stages/check/profiles DESTINATION ${CMAKE_INSTALL_DATADIR}/runcert
  FILES_MATCHING PATTERN "*.yaml")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME runcert)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "certifies speed-record attempts from GNSS recordings")
set(CPACK_PACKAGE_DESCRIPTION
"runcert measures a speed-record attempt, of land yachts first, from recorded
satellite positions. Recordings go in; a measurement report that can be signed
comes out, with the uncertainty of the speed and an answer for each requirement
of the rules. Every step between them is a file that can be audited, and the
whole can be computed again by anybody.")
if(RUNCERT_HOME_URL)
  set(CPACK_DEBIAN_PACKAGE_HOMEPAGE ${RUNCERT_HOME_URL})
endif()
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER ${RUNCERT_MAINTAINER})
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Depends is what the first answer needs. The others serve some recordings and some signatures, and
# whoever lacks one is told its name.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "bubblewrap, weasyprint, fonts-dejavu-core")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "gpsbabel, rtklib, openssh-client, openssl, poppler-utils, \
libpodofo-utils, fonts-freefont-ttf, fonts-wqy-microhei")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS minisign)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR})
include(CPack)
