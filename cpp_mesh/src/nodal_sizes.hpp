// Wanted sizes that were given by the cells of another mesh of the same body.
#ifndef CPP_MESH_NODAL_SIZES_HPP
#define CPP_MESH_NODAL_SIZES_HPP

#include "locate.hpp"
#include "plane_mesh.hpp"

#include <utility>
#include <vector>

namespace cpp_mesh {

// Linear in the cells. At a node it is the geometric mean of the sizes of the cells around it,
// which count up to `largest`; then growth is limited so that a cell is at most about 1.3 times as
// large as its neighbour.
class NodalSizes {
public:
    // A size that grows by this much per distance lets neighbours differ by a factor of about 1.3.
    static constexpr double growth = 0.3;

    // A size per cell [m].
    NodalSizes(const PlaneMesh& mesh, const std::vector<double>& cell_size, double largest);
    // Those of a checkpoint.
    NodalSizes(std::vector<Vec2> xy, std::vector<Triangle> cells, std::vector<double> size)
        : xy_(std::move(xy)), cells_(std::move(cells)), size_(std::move(size)), tree_(xy_, cells_) {
    }
    NodalSizes(const NodalSizes&) = delete;
    NodalSizes& operator=(const NodalSizes&) = delete;

    double operator()(Vec2 p) const;
    const std::vector<Vec2>& xy() const { return xy_; }
    const std::vector<Triangle>& cells() const { return cells_; }
    const std::vector<double>& sizes() const { return size_; }

private:
    void limit_growth();
    double at_nearest_node(Vec2 p) const;

    std::vector<Vec2> xy_;
    std::vector<Triangle> cells_;
    std::vector<double> size_; // at the nodes
    CellTree tree_;
};

} // namespace cpp_mesh

#endif
