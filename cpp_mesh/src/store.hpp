// The bytes of a mesh, for a checkpoint, and the same mesh from them.
#ifndef CPP_MESH_STORE_HPP
#define CPP_MESH_STORE_HPP

#include "mesh.hpp"

#include <cstddef>

namespace cpp_mesh {

// All but the map of a remeshed mesh, which is used once, right after the remeshing. The layout is
// that of the program's types: checkpoints are read by the program that wrote them.
std::size_t stored_size(const Mesh& mesh);
void store(const Mesh& mesh, char* bytes);
Mesh load(const char* bytes, std::size_t n_bytes);

} // namespace cpp_mesh

#endif
