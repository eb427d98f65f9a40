// The one exception of the library: what cannot be meshed, and why.
#ifndef CPP_MESH_ERRORS_HPP
#define CPP_MESH_ERRORS_HPP

#include <stdexcept>
#include <string>

namespace cpp_mesh {

class MeshError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// Fractures are counted from 1 in messages, as in the scene file.
inline std::string fracture_name(int fracture) {
    return "fracture " + std::to_string(fracture + 1);
}

// A number as a user would write it.
std::string number_text(double value);

} // namespace cpp_mesh

#endif
