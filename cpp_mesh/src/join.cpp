#include "join.hpp"

#include "errors.hpp"

#include <limits>

namespace cpp_mesh {

namespace {

// An end comes nearer to a place that lies ahead: the cosine of the angle between its direction and
// the way to the place is at least this, which leaves out fractures that it passes alongside.
constexpr double least_cosine = 0.02;

// A place on the fracture itself is approached anew if the way back to it along the fracture is
// more than this many times as long as the straight one; at a kink by 120 degrees it is twice as
// long.
constexpr double detour = 3.0;

// Targets nearer than this to a given point are moved there, in units of the least distance at
// which points can be meshed apart.
constexpr double reach_of_points = 10.0;

class TargetSearch {
public:
    TargetSearch(const Specification& specification, const Network& network, Vec2 point,
                 int fracture, int end)
        : domain_(specification.domain), point_(point), fracture_(fracture),
          tolerances_(tolerances_for(domain_.box(), specification.size_fracture)),
          graph_(build_graph(segments_of(network), specification.fixed_points, domain_,
                             specification.is_window, tolerances_)) {
        best_.distance = std::numeric_limits<double>::max();
        find_end(network, end);
    }

    JoinTarget run() {
        for (const GraphEdge& edge : graph_.edges)
            try_edge(edge);
        for (int edge = 0; edge < domain_.edge_count(); ++edge)
            try_boundary(edge);
        if (best_.distance == std::numeric_limits<double>::max())
            throw MeshError(fracture_name(fracture_) + " has nothing ahead that it could join");
        return best_;
    }

private:
    Vec2 at(int point) const { return graph_.points[point].xy; }

    // Place, direction and arc length of the end. The direction is that of the growth, if the point
    // lies off the end, else that of the last segment.
    void find_end(const Network& network, int end) {
        const int last = end == 0 ? network.first[fracture_] : network.first[fracture_ + 1] - 1;
        const int before = end == 0 ? last + 1 : last - 1;
        tip_ = network.xy[last];
        const bool is_at_end = distance(tip_, point_) <= tolerances_.near_miss;
        direction_ = unit(is_at_end ? tip_ - network.xy[before] : point_ - tip_);
        bool is_found = false; // edges of a fracture follow each other along it
        for (const GraphEdge& edge : graph_.edges) {
            if (edge.fracture == fracture_ && (end == 1 || !is_found)) {
                s_tip_ = edge.s[end];
                is_found = true;
            }
        }
    }

    bool is_ahead(Vec2 place) const {
        const Vec2 way = place - tip_;
        return length(way) > tolerances_.same && dot(direction_, way) >= least_cosine * length(way);
    }

    void try_edge(const GraphEdge& edge) {
        const Vec2 a = at(edge.point[0]), b = at(edge.point[1]);
        double share = nearest_parameter(point_, a, b);
        Vec2 place = along(a, b, share);
        for (int k = 0; k < 2; ++k) {
            if (distance(place, at(edge.point[k])) <= reach_of_points * tolerances_.near_miss) {
                place = at(edge.point[k]);
                share = k;
            }
        }
        const double gap = distance(point_, place), s = edge.s[0] + share * (edge.s[1] - edge.s[0]);
        if (!(gap < best_.distance) || !is_ahead(place))
            return;
        if (edge.fracture == fracture_ &&
            std::abs(s - s_tip_) + distance(tip_, point_) <= detour * gap)
            return;
        best_ = {place, gap, edge.fracture, s, 0};
    }

    void try_boundary(int edge) {
        const Vec2 a = domain_.start(edge), b = domain_.stop(edge);
        Vec2 place =
            domain_.snapped(along(a, b, nearest_parameter(point_, a, b)), tolerances_.same);
        std::vector<Vec2> points = {a, b};
        for (const GraphPoint& point : graph_.points)
            if (point.on_boundary && domain_.is_on_edge(point.xy, edge))
                points.push_back(point.xy);
        double nearest = reach_of_points * tolerances_.near_miss;
        const Vec2 foot = place;
        for (const Vec2& p : points) {
            if (distance(p, foot) <= nearest) {
                nearest = distance(p, foot);
                place = p;
            }
        }
        const double gap = distance(point_, place);
        if (gap < best_.distance && is_ahead(place))
            best_ = {place, gap, -1, 0.0, domain_.side(edge)};
    }

    const Domain& domain_;
    const Vec2 point_;
    const int fracture_;
    const Tolerances tolerances_;
    const Graph graph_;
    Vec2 tip_, direction_;
    double s_tip_ = 0.0;
    JoinTarget best_;
};

} // namespace

JoinTarget nearest_target(const Specification& specification, const Network& network, Vec2 point,
                          int fracture, int end) {
    if (fracture < 0 || fracture >= network.size() || end < 0 || end > 1)
        throw MeshError("there is no such end of a fracture");
    if (!std::isfinite(point.x) || !std::isfinite(point.y))
        throw MeshError("the point whose target is wanted is not a number");
    return TargetSearch(specification, network, point, fracture, end).run();
}

} // namespace cpp_mesh
