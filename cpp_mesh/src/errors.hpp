// The one exception of the library: what cannot be meshed, who is to blame, where, and why.
#ifndef CPP_MESH_ERRORS_HPP
#define CPP_MESH_ERRORS_HPP

#include "geometry.hpp"

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace cpp_mesh {

// As cm_fault_kind of c_api.h.
enum class FaultKind {
    other = 1,
    number,
    body,
    outside,
    boundary,
    too_short,
    too_near,
    angle,
    overlap
};

// As cm_culprit_kind of c_api.h.
enum class CulpritKind { fracture = 1, corner, edge, fixed_point };

// One of the inputs, counted from 0 within its kind.
struct Culprit {
    CulpritKind kind = CulpritKind::fracture;
    int number = 0;
};

inline Culprit fracture_culprit(int fracture) {
    return {CulpritKind::fracture, fracture};
}

struct Fault {
    FaultKind kind = FaultKind::other;
    std::vector<Culprit> culprits; // at most two, the first is the subject of the reason
    std::optional<Vec2> place;
    std::string reason; // a sentence in which {1} and {2} stand for the culprits
};

class MeshError : public std::runtime_error {
public:
    explicit MeshError(const std::string& message)
        : std::runtime_error(message), fault_{FaultKind::other, {}, std::nullopt, message} {}

    // {at} in the reason becomes "at (x, y)".
    explicit MeshError(Fault fault);

    const Fault& fault() const { return fault_; }

private:
    Fault fault_;
};

// Fractures are counted from 1 in messages, as in the scene file.
inline std::string fracture_name(int fracture) {
    return "fracture " + std::to_string(fracture + 1);
}

// A number as a user would write it.
std::string number_text(double value);

} // namespace cpp_mesh

#endif
