#include "planned_sizes.hpp"

#include "boundary.hpp"
#include "judge.hpp"
#include "narrow_places.hpp"

#include <cmath>

namespace cpp_mesh {

namespace {

// Midpoint rule on squares that are halved until they are smaller than `squares` cells.
class AreaIntegral {
public:
    AreaIntegral(const Domain& domain, const SizeField& size, double squares, int most)
        : domain_(domain), size_(size), squares_(squares), left_(most) {
        const Rectangle& box = domain.box();
        const double side = std::min(box.width(), box.height());
        const int columns = static_cast<int>(std::ceil(box.width() / side)),
                  rows = static_cast<int>(std::ceil(box.height() / side));
        for (int i = 0; i < columns; ++i)
            for (int j = 0; j < rows; ++j)
                add({box.x_min + (i + 0.5) * box.width() / columns,
                     box.y_min + (j + 0.5) * box.height() / rows},
                    {0.5 * box.width() / columns, 0.5 * box.height() / rows});
    }

    double total() const { return total_; } // of 1/size^2 [-]
    bool is_complete() const { return left_ > 0; }

private:
    static constexpr double smallest_part = 0.3; // of a triangle; fitted

    void add(Vec2 centre, Vec2 half) {
        const double size = size_(centre), side = 2.0 * std::max(half.x, half.y);
        if (--left_ > 0 && side > squares_ * size) {
            for (const Vec2 corner : {Vec2{-0.5, -0.5}, {-0.5, 0.5}, {0.5, -0.5}, {0.5, 0.5}})
                add({centre.x + corner.x * half.x, centre.y + corner.y * half.y}, 0.5 * half);
        } else if (domain_.is_rectangle() || domain_.depth(centre) >= 0.0) {
            // Where sizes grow, triangles are as small as their smallest part asks for.
            const double step = 0.5 * size;
            const double slope = std::hypot(size_({centre.x + step, centre.y}) - size,
                                            size_({centre.x, centre.y + step}) - size) /
                                 step;
            const double smaller = size / (1.0 + smallest_part * slope);
            total_ += 4.0 * half.x * half.y / (smaller * smaller);
        }
    }

    const Domain& domain_;
    const SizeField& size_;
    double squares_;
    int left_;
    double total_ = 0.0;
};

double cells_along(Vec2 a, Vec2 b, const SizeField& size) {
    constexpr double most = 1e4; // that are counted one by one
    const double about = distance(a, b) / size(0.5 * (a + b));
    return about > most ? about : static_cast<double>(divide_segment(a, b, size).size() - 1);
}

} // namespace

SizeField planned_sizes(const Specification& specification, const Graph& graph,
                        const std::vector<RosettePlan>& plans,
                        std::shared_ptr<const NodalSizes> wanted) {
    const Domain& domain = specification.domain;
    SizeField size;
    if (wanted != nullptr) {
        size = SizeField(std::move(wanted));
    } else {
        std::vector<SizeSource> sources;
        for (const GraphEdge& edge : graph.edges)
            sources.push_back({graph.points[edge.point[0]].xy, graph.points[edge.point[1]].xy,
                               specification.size_along(edge.fracture),
                               specification.largest_along(edge.fracture)});
        size = SizeField(std::move(sources), domain, specification.size_boundary);
        size.arrange();
        size.set_foci(specification.foci);
    }
    if (size.follows_other_mesh() || specification.is_for_elements())
        size.make_scale_free();
    size.set_discs(
        rosette_discs(graph, plans, specification.rosette_sectors, specification.ring_slope));
    if (specification.joint_size > 0.0)
        for (const Joint& joint : joints_of(graph))
            size.add(corner_disc(joint.xy,
                                 specification.foci.at_corner(specification.joint_size, joint.xy)));
    for (SizeDisc disc : specification.refined) {
        disc.size = specification.foci.at_corner(disc.size, disc.centre);
        size.add(disc);
    }
    // Cells between fractures that meet, or almost do, must not be much longer than the gap
    // between the fractures.
    if (size.is_scale_free() || (!specification.is_window &&
                                 (!joints_of(graph).empty() || has_near_ends(graph, domain, size))))
        limit_sizes_in_narrow_places(graph, domain, size);
    size.arrange();
    return size;
}

ExpectedCells expected_cells(const Specification& specification, const Graph& graph,
                             const std::vector<RosettePlan>& plans) {
    // Equilateral triangles, 4/sqrt(3), times what gmsh made of such integrals in 13 networks
    constexpr double per_square = 1.04 * 2.309401076758503;
    constexpr int coarsest = 64; // squares over cells, at first
    constexpr int most = 200000; // evaluations of the sizes
    const SizeField size = planned_sizes(specification, graph, plans, nullptr);
    ExpectedCells expected;
    for (int squares = coarsest; squares >= 1; squares /= 2) {
        const AreaIntegral integral(specification.domain, size, squares, most);
        if (!integral.is_complete() && expected.cells > 0.0)
            break;
        expected.cells = per_square * integral.total();
    }
    for (const GraphEdge& edge : graph.edges)
        expected.fracture_cells +=
            cells_along(graph.points[edge.point[0]].xy, graph.points[edge.point[1]].xy, size);
    return expected;
}

} // namespace cpp_mesh
