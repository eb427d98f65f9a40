// A bound on what gmsh may do for one region.
#ifndef CPP_MESH_WORK_LIMIT_HPP
#define CPP_MESH_WORK_LIMIT_HPP

#include <algorithm>

namespace cpp_mesh {

// gmsh asks for the size wherever it puts a node or tries to. Nodes as far apart as the sizes want
// cover the region about once: each holds sqrt(3)/2 of its size squared. What is asked for far
// beyond that leads nowhere.
class WorkLimit {
public:
    // How many times a region may be covered. The meshes of the tests and of the scenes in inputs/
    // cover theirs 1.3 to 3.1 times.
    static constexpr double usual_coverage = 20.0;

    WorkLimit(double area, double coverage) : area_(area), left_(coverage * area) {}

    // A question at a place that wants this size. False once it is too much.
    bool allows(double size) {
        left_ -= std::clamp(size * size, area_ / most_nodes, area_ / few_nodes);
        return !is_reached();
    }

    bool is_reached() const { return !(left_ > 0.0); }

private:
    static constexpr double most_nodes = 1e8; // so tiny sizes have an end too
    static constexpr double few_nodes = 1e3;  // regions may be smaller than the sizes

    double area_;
    double left_;
};

} // namespace cpp_mesh

#endif
