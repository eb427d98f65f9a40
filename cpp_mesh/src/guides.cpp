#include "guides.hpp"

#include <map>
#include <utility>

namespace cpp_mesh {

namespace {

// Vertices where a line turns by more than this stay nodes [rad].
constexpr double sharp_turn = 0.3;

// Edges that meet each other or the boundary leave at least this angle [rad].
constexpr double least_angle = 40.0 * pi / 180.0;

// In terms of the size of cells there: what an edge keeps clear of, and how short it may be.
constexpr double clearance = 0.7;
constexpr double shortest = 0.45;

using Line = std::vector<Vec2>;

// The part of a segment in the rectangle (Liang and Barsky 1984), as parameters; empty if first >
// last.
std::pair<double, double> share_inside(const Rectangle& box, Vec2 a, Vec2 b) {
    double first = 0.0, last = 1.0;
    const auto clip = [&](double from, double step, double low, double high) {
        if (step == 0.0) {
            if (from < low || from > high)
                first = 2.0;
            return;
        }
        const double t = (low - from) / step, u = (high - from) / step;
        first = std::max(first, std::min(t, u));
        last = std::min(last, std::max(t, u));
    };
    clip(a.x, b.x - a.x, box.x_min, box.x_max);
    clip(a.y, b.y - a.y, box.y_min, box.y_max);
    return {first, last};
}

// A point where a segment crosses a side is exactly on it.
Vec2 on_side(const Rectangle& box, Vec2 p, double rounding) {
    for (const double side : {box.x_min, box.x_max})
        if (std::abs(p.x - side) <= rounding)
            p.x = side;
    for (const double side : {box.y_min, box.y_max})
        if (std::abs(p.y - side) <= rounding)
            p.y = side;
    return p;
}

std::vector<Line> parts_inside(const Rectangle& box, const Line& line) {
    const double rounding = 1e-12 * box.diagonal();
    std::vector<Line> parts;
    bool goes_on = false;
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        const auto [first, last] = share_inside(box, line[k], line[k + 1]);
        const bool is_in = first < last;
        if (is_in) {
            const Vec2 start = on_side(box, along(line[k], line[k + 1], first), rounding);
            const Vec2 stop = on_side(box, along(line[k], line[k + 1], last), rounding);
            if (!goes_on || first > 0.0)
                parts.push_back({start});
            parts.back().push_back(last < 1.0 ? stop : on_side(box, line[k + 1], rounding));
        }
        goes_on = is_in && last >= 1.0;
    }
    return parts;
}

// Nodes along a line: its ends, its corners, and what the sizes ask for between them.
Line divided(const Line& line, const SizeField& size) {
    Line nodes = {line.front()};
    std::vector<char> is_bound = {1};
    Vec2 last = line.front();
    for (std::size_t k = 1; k < line.size(); ++k) {
        const Vec2 here = line[k];
        bool is_corner = k + 1 == line.size() || distance(line[k - 1], here) > size(here);
        if (k + 1 < line.size())
            is_corner = is_corner || distance(here, line[k + 1]) > size(here) ||
                        angle_between(here - line[k - 1], line[k + 1] - here) > sharp_turn;
        if (!is_corner && distance(last, here) < size(here))
            continue;
        if (is_corner && distance(last, here) < shortest * size(here) && !is_bound.back()) {
            nodes.pop_back(); // of a bend: the corner takes its place
            is_bound.pop_back();
            last = nodes.back();
        }
        const std::vector<double> t = divide_segment(last, here, size);
        for (std::size_t i = 1; i < t.size(); ++i) {
            nodes.push_back(i + 1 < t.size() ? along(last, here, t[i]) : here);
            is_bound.push_back(i + 1 < t.size() || is_corner);
        }
        last = here;
    }
    return nodes;
}

class EdgeChoice {
public:
    EdgeChoice(const Domain& domain, const Graph& graph, const std::vector<RosettePlan>& rosettes,
               const SizeField& size)
        : domain_(domain), graph_(graph), rosettes_(rosettes), size_(size) {
        for (const Vec2& corner : domain.corners())
            on_boundary_.push_back(corner);
        for (const GraphPoint& point : graph.points)
            if (point.on_boundary)
                on_boundary_.push_back(point.xy);
    }

    void take(Vec2 a, Vec2 b) {
        const double wanted = size_(0.5 * (a + b));
        if (distance(a, b) < shortest * wanted || !is_clear(a, b, clearance * wanted) ||
            !fits_boundary(a, b, wanted) || !fits_boundary(b, a, wanted))
            return;
        made_.edges.push_back({place(a), place(b)});
    }

    GuideEdges made() { return std::move(made_); }

private:
    // Neither fractures nor rosettes, whose inside gmsh does not mesh, nor other edges are near.
    bool is_clear(Vec2 a, Vec2 b, double gap) const {
        for (const RosettePlan& rosette : rosettes_)
            if (distance_to_segment(graph_.points[rosette.point].xy, a, b) < rosette.radius + gap)
                return false;
        for (const GraphEdge& edge : graph_.edges)
            if (segment_distance(a, b, graph_.points[edge.point[0]].xy,
                                 graph_.points[edge.point[1]].xy) < gap)
                return false;
        for (const auto& edge : made_.edges) {
            const Vec2 c = made_.places[edge[0]], d = made_.places[edge[1]];
            if (a == c || a == d || b == c || b == d) {
                const Vec2 joint = a == c || a == d ? a : b;
                const Vec2 far = joint == a ? b : a, other = joint == c ? d : c;
                if (angle_between(far - joint, other - joint) < least_angle)
                    return false;
            } else if (segment_distance(a, b, c, d) < gap) {
                return false;
            }
        }
        return true;
    }

    // An end is well inside, or on the boundary with room beside it and at a fair angle.
    bool fits_boundary(Vec2 end, Vec2 other, double wanted) const {
        if (!domain_.is_on_boundary(end))
            return domain_.depth(end) > shortest * wanted;
        for (Vec2 p : on_boundary_)
            if (distance(p, end) < clearance * wanted)
                return false;
        return domain_.angle_with_boundary(end, other - end) >= least_angle;
    }

    int place(Vec2 p) {
        const auto [entry, is_new] = number_.try_emplace({p.x, p.y}, made_.places.size());
        if (is_new) {
            made_.places.push_back(p);
            made_.on_boundary.push_back(domain_.is_on_boundary(p) ? 1 : 0);
            if (made_.on_boundary.back())
                on_boundary_.push_back(p);
        }
        return entry->second;
    }

    const Domain& domain_;
    const Graph& graph_;
    const std::vector<RosettePlan>& rosettes_;
    const SizeField& size_;
    Line on_boundary_; // what is a node of the boundary in any case
    std::map<std::pair<double, double>, int> number_;
    GuideEdges made_;
};

} // namespace

GuideEdges guide_edges(const std::vector<std::vector<Vec2>>& lines, const Domain& domain,
                       const Graph& graph, const std::vector<RosettePlan>& rosettes,
                       const SizeField& size) {
    EdgeChoice choice(domain, graph, rosettes, size);
    for (const Line& line : lines) {
        for (const Line& part : parts_inside(domain.box(), line)) {
            const Line nodes = divided(part, size);
            for (std::size_t k = 0; k + 1 < nodes.size(); ++k)
                choice.take(nodes[k], nodes[k + 1]);
        }
    }
    return choice.made();
}

} // namespace cpp_mesh
