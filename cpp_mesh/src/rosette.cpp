#include "rosette.hpp"

#include "errors.hpp"

#include <cmath>

namespace cpp_mesh {

namespace {

// Turns at the last kink by up to this leave room for the ring right next to the kink.
constexpr double largest_turn = 75.0 * pi / 180.0;

// Growth of cell sizes per distance outside a ring, whose triangles are smaller than those around:
// integrals around tips need some rings of cells.
constexpr double growth_around = 0.3;

// gmsh tells points apart down to some 1e-11 of the body's diagonal, and does not end beyond.
constexpr double least_radius = 1e-10;

// Least length of a piece of the segment behind the ring, in radii.
constexpr double least_piece = 0.5;

// Room for the ring beside its own last segment. The crack may be a ring radius long, else the rest
// of the segment must hold a cell of about the same length.
double room_on_segment(double wanted, double segment_length, bool kink_is_gentle) {
    if (kink_is_gentle && segment_length <= wanted * (1.0 + 1e-9))
        return segment_length;
    return std::min(wanted, 0.5 * segment_length);
}

} // namespace

double RosetteRadii::wanted(int fracture, int end) const {
    if (fracture < static_cast<int>(at_end.size()) && at_end[fracture][end] > 0.0)
        return at_end[fracture][end];
    return usual;
}

std::vector<RosettePlan> plan_rosettes(const Graph& graph, const Domain& domain,
                                       const RosetteRadii& radii) {
    std::vector<std::vector<int>> star(graph.points.size());
    for (int e = 0; e < static_cast<int>(graph.edges.size()); ++e)
        for (int p : graph.edges[e].point)
            star[p].push_back(e);
    const auto at = [&](int point) { return graph.points[point].xy; };
    const auto is_tip = [&](int p) { return star[p].size() == 1 && !graph.points[p].on_boundary; };

    std::vector<RosettePlan> plans;
    for (int e = 0; e < static_cast<int>(graph.edges.size()); ++e) {
        const GraphEdge& edge = graph.edges[e];
        for (int end = 0; end < 2; ++end) {
            const int tip = edge.point[end], foot = edge.point[1 - end];
            if (!is_tip(tip))
                continue;
            RosettePlan plan{tip, e, end, radii.wanted(edge.fracture, end),
                             unit(at(tip) - at(foot))};
            const double own_length = distance(at(tip), at(foot));
            if (is_tip(foot)) {
                plan.radius = std::min(plan.radius, own_length / 3.0);
            } else {
                bool is_gentle = star[foot].size() == 2;
                for (int next : star[foot]) {
                    const GraphEdge& other = graph.edges[next];
                    const int far = other.point[0] == foot ? other.point[1] : other.point[0];
                    if (next != e &&
                        angle_between(at(foot) - at(far), plan.direction) > largest_turn)
                        is_gentle = false;
                }
                plan.radius = room_on_segment(plan.radius, own_length, is_gentle);
            }
            for (int other = 0; other < static_cast<int>(graph.edges.size()); ++other) {
                const auto& point = graph.edges[other].point;
                if (other == e)
                    continue;
                const bool is_next = point[0] == foot || point[1] == foot;
                const double gap = distance_to_segment(at(tip), at(point[0]), at(point[1]));
                if (!is_next || gap < 0.999 * own_length)
                    plan.radius = std::min(plan.radius, 0.5 * gap);
            }
            for (int other = 0; other < static_cast<int>(graph.points.size()); ++other)
                if (other != tip && is_tip(other))
                    plan.radius = std::min(plan.radius, distance(at(tip), at(other)) / 3.0);
            for (int fixed : graph.fixed_points)
                if (fixed != tip && star[fixed].empty())
                    plan.radius = std::min(plan.radius, 0.5 * distance(at(tip), at(fixed)));
            plan.radius = std::min(plan.radius, 0.5 * domain.depth(at(tip)));
            if (plan.radius < own_length * (1.0 - 1e-9))
                plan.radius = std::min(plan.radius, own_length / (1.0 + least_piece));
            const double least = least_radius * domain.box().diagonal();
            if (!(plan.radius >= least))
                throw MeshError({FaultKind::too_short,
                                 {fracture_culprit(edge.fracture)},
                                 at(tip),
                                 "{1} has elements of " + number_text(plan.radius) +
                                     " m around its end {at}, but in this body they must have at "
                                     "least " +
                                     number_text(least) + " m"});
            plans.push_back(plan);
        }
    }
    return plans;
}

std::vector<SizeDisc> rosette_discs(const Graph& graph, const std::vector<RosettePlan>& plans,
                                    int sectors, double far_slope) {
    std::vector<SizeDisc> discs;
    for (const RosettePlan& plan : plans)
        discs.push_back({graph.points[plan.point].xy, plan.radius,
                         2.0 * plan.radius * std::sin(pi / sectors), growth_around,
                         far_slope - growth_around});
    return discs;
}

std::vector<int> add_ring(Vec2 tip, Vec2 direction, double radius, int sectors, int crack_node,
                          std::vector<Vec2>& xy) {
    std::vector<int> ring = {crack_node};
    for (int k = 1; k < sectors; ++k) {
        ring.push_back(static_cast<int>(xy.size()));
        xy.push_back(tip + turned(-radius * direction, 2.0 * pi * k / sectors));
    }
    return ring;
}

void add_sectors(int tip_node, const std::vector<int>& ring, std::vector<Triangle>& cells) {
    for (std::size_t k = 0; k < ring.size(); ++k)
        cells.push_back({tip_node, ring[k], ring[(k + 1) % ring.size()]});
}

} // namespace cpp_mesh
