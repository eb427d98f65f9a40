# cmake --install: programs, Python packages, shipped scenes and pages, so that PREFIX/bin/wingcrack
# works without the folder of the sources (docs/installing.md). The launcher is that of the sources,
# with other files for set-up and build, which install and build nothing.
set(home lib/wingcrack)

set_target_properties(
  wingcrack-solver
  wingcrack-mechanics
  PROPERTIES INSTALL_RPATH "$ORIGIN/../${home}" INSTALL_RPATH_USE_LINK_PATH FALSE
)
install(TARGETS wingcrack-solver RUNTIME DESTINATION bin)
install(TARGETS wingcrack-mechanics RUNTIME DESTINATION bin OPTIONAL)
if(Gmsh_WHEEL_LIBRARY)
  # From a Python environment, which may go: its library comes along.
  install(FILES ${Gmsh_LIBRARY} DESTINATION ${home})
else()
  set_target_properties(
    wingcrack-solver wingcrack-mechanics PROPERTIES INSTALL_RPATH_USE_LINK_PATH TRUE
  )
endif()

configure_file(cmake/installed/build.sh.in ${PROJECT_BINARY_DIR}/installed/build.sh @ONLY)
install(PROGRAMS wingcrack DESTINATION ${home})
install(
  FILES cmake/installed/setup.sh ${PROJECT_BINARY_DIR}/installed/build.sh tools/start.py
  DESTINATION ${home}/tools
)
install(
  DIRECTORY post
  DESTINATION ${home}
  PATTERN "tests*" EXCLUDE
  PATTERN "__pycache__" EXCLUDE
  PATTERN "*.egg-info" EXCLUDE
  PATTERN "bench" EXCLUDE
  PATTERN "wingcrack_docs" EXCLUDE
)
install(DIRECTORY inputs docs DESTINATION share/wingcrack)
install(
  FILES README.md CHANGELOG.md LICENSE CITATION.cff requirements.txt requirements_study.txt
        requirements_maps.txt requirements_maps_gis.txt requirements_movies.txt
        requirements_water.txt
  DESTINATION share/wingcrack
)

# The command, and the solver where the Python packages look for it: links within the prefix.
install(
  CODE
    "
  set(prefix \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}\")
  set(app \"\${prefix}/${home}/build/release/fortran/app\")
  file(MAKE_DIRECTORY \"\${app}\")
  file(CREATE_LINK ../${home}/wingcrack \"\${prefix}/bin/wingcrack\" SYMBOLIC)
  file(CREATE_LINK ../../../../../../bin/wingcrack-solver \"\${app}/wingcrack-solver\" SYMBOLIC)
"
)
