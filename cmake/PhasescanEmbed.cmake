# phasescan_embed(<output.cpp> <base folder> <file>...): the files' text inside the program, found by its path below the folder.
# The command then needs no installed data, in whatever folder it runs.
function(phasescan_embed output base)
  set(entries "")
  foreach(path IN LISTS ARGN)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${path}")
    file(READ "${path}" text)
    file(RELATIVE_PATH name "${base}" "${path}")
    string(APPEND entries "    {\"${name}\", R\"embed(${text})embed\"},\n")
  endforeach()
  set(code "#include \"sim/embedded.hpp\"\n\nnamespace phasescan::sim {\n\nstd::span<const EmbeddedFile> embedded_files() {\n")
  string(APPEND code "  static constexpr EmbeddedFile files[] = {\n${entries}  };\n  return files;\n}\n\n}  // namespace phasescan::sim\n")
  file(CONFIGURE OUTPUT "${output}" CONTENT "${code}" @ONLY)
endfunction()
