#include "network.hpp"

#include "box_grid.hpp"
#include "errors.hpp"

#include <utility>

namespace cpp_mesh {

namespace {

// A point on a segment, by its distance from the segment's first end.
struct Cut {
    double distance;
    int point;
};

class GraphBuilder {
public:
    GraphBuilder(const std::vector<Segment>& segments, const std::vector<Vec2>& fixed_points,
                 const Domain& domain, bool clip, const Tolerances& tolerances)
        : segments_(segments), fixed_points_(fixed_points), domain_(domain), box_(domain.box()),
          clip_(clip), tolerances_(tolerances), cuts_(segments.size()),
          point_grid_(box_, 2 * segments.size()) {}

    Graph build() {
        for (int i = 0; i < count(); ++i)
            place(i);
        check_inner_vertices();
        for (std::size_t k = 0; k < fixed_points_.size(); ++k)
            place_fixed(static_cast<int>(k));
        intersect_all();
        for (int i = 0; i < count(); ++i)
            divide(i);
        for (const std::vector<Cut>& cuts : cuts_)
            graph_.segment_points.push_back(cuts.empty()
                                                ? std::array<int, 2>{-1, -1}
                                                : std::array<int, 2>{cuts[0].point, cuts[1].point});
        check_angles();
        check_boundary();
        return std::move(graph_);
    }

private:
    int count() const { return static_cast<int>(segments_.size()); }
    bool is_placed(int i) const { return !cuts_[i].empty(); }
    Vec2 at(int point) const { return graph_.points[point].xy; }
    Vec2 start(int i) const { return at(cuts_[i][0].point); }
    Vec2 stop(int i) const { return at(cuts_[i][1].point); }

    [[noreturn]] static void refuse(FaultKind kind, const std::vector<Culprit>& culprits, Vec2 at,
                                    const std::string& reason) {
        throw MeshError({kind, culprits, at, reason});
    }

    Culprit owner(int segment) const { return fracture_culprit(segments_[segment].fracture); }

    // The fractures of two segments.
    std::vector<Culprit> owners(int i, int j) const {
        const int a = segments_[i].fracture, b = segments_[j].fracture;
        if (a == b)
            return {fracture_culprit(a)};
        return {fracture_culprit(std::min(a, b)), fracture_culprit(std::max(a, b))};
    }

    // What a sentence calls them.
    std::string pair_name(int i, int j) const {
        return segments_[i].fracture == segments_[j].fracture ? "parts of {1}" : "{1} and {2}";
    }

    // The graph point at p, which is made if there is none within the tolerance.
    int point_at(Vec2 p) {
        const Vec2 reach = {tolerances_.same, tolerances_.same};
        for (int k : point_grid_.candidates(p - reach, p + reach))
            if (distance(at(k), p) <= tolerances_.same)
                return k;
        p = snapped(p);
        const int number = static_cast<int>(graph_.points.size());
        graph_.points.push_back({p, domain_.is_on_boundary(p)});
        point_grid_.add(number, p, p);
        return number;
    }

    // Put the ends of a segment into the graph, cut at the rectangle's sides (Liang and Barsky
    // 1984).
    void place(int i) {
        const Segment& segment = segments_[i];
        const Vec2 a = segment.end[0], b = segment.end[1];
        if (!(distance(a, b) > tolerances_.near_miss) && segment.old_cell < 0)
            refuse(FaultKind::too_short, {owner(i)}, a,
                   "{1} has a segment of length " + number_text(distance(a, b)) +
                       " m {at}, which is too short to be meshed; remove a vertex");
        Vec2 p = snapped(a), q = snapped(b);
        if (clip_) {
            if (!clip(p, q))
                return;
        } else if (domain_.is_left_by(p, q)) {
            const Vec2 outside = domain_.depth(p) < domain_.depth(q) ? a : b;
            if (domain_.depth(p) < 0.0 || domain_.depth(q) < 0.0)
                refuse(FaultKind::outside, {owner(i)}, outside,
                       "{1} leaves the domain {at}; shorten it or enlarge the domain");
            refuse(FaultKind::outside, {owner(i)}, b,
                   "{1} leaves the domain on the way to its vertex {at}; let it stay within");
        }
        const int k = point_at(p), l = point_at(q);
        check_depth(i, k);
        check_depth(i, l);
        if (k == l)
            return;
        check_path(i, at(k), at(l));
        cuts_[i] = {{0.0, k}, {distance(at(k), at(l)), l}};
    }

    // Cut the segment p-q at the rectangle's sides (Liang and Barsky 1984); false if nothing is
    // left.
    bool clip(Vec2& p, Vec2& q) const {
        double t_in = 0.0, t_out = 1.0;
        const auto cut = [&](double speed, double room) { // towards a side, room up to it
            if (speed < 0.0)
                t_in = std::max(t_in, room / speed);
            else if (speed > 0.0)
                t_out = std::min(t_out, room / speed);
            else if (room < 0.0)
                t_out = -1.0;
        };
        const Vec2 a = p, b = q;
        cut(a.x - b.x, a.x - box_.x_min);
        cut(b.x - a.x, box_.x_max - a.x);
        cut(a.y - b.y, a.y - box_.y_min);
        cut(b.y - a.y, box_.y_max - a.y);
        if ((t_out - t_in) * distance(a, b) <= tolerances_.same)
            return false;
        if (t_in > 0.0)
            p = snapped(along(a, b, t_in));
        if (t_out < 1.0)
            q = snapped(along(a, b, t_out));
        return true;
    }

    // A point within the tolerance of the boundary lies on it.
    Vec2 snapped(Vec2 p) const { return domain_.snapped(p, tolerances_.same); }

    void check_path(int i, Vec2 a, Vec2 b) const {
        if (domain_.common_side(a, b) != 0)
            refuse(FaultKind::boundary, {owner(i)}, a,
                   "{1} runs along the boundary {at}; a fracture may only end there");
        if (domain_.is_rectangle())
            return;
        const int corner = domain_.corner_beside(a, b);
        if (corner < 0)
            return;
        const Vec2 p = domain_.corners()[corner];
        const double gap = distance_to_segment(p, a, b);
        if (gap < tolerances_.near_miss)
            refuse(FaultKind::too_near, {owner(i), {CulpritKind::corner, corner}}, p,
                   "{1} passes within " + number_text(gap) +
                       " m of {2} {at}; let it end there or move it away");
    }

    // A fracture meets the boundary with its ends only.
    void check_inner_vertices() const {
        for (int i = 0; !clip_ && i + 1 < count(); ++i) {
            if (segments_[i].fracture != segments_[i + 1].fracture || !is_placed(i) ||
                !is_placed(i + 1))
                continue;
            const int vertex = cuts_[i][1].point;
            if (vertex == cuts_[i + 1][0].point && graph_.points[vertex].on_boundary)
                refuse(FaultKind::boundary, {owner(i)}, at(vertex),
                       "{1} has an inner vertex on the boundary {at}; a fracture may only end "
                       "there");
        }
    }

    // A point that is to become a node: of its own, or on the segments that it lies on.
    void place_fixed(int number) {
        const Culprit self = {CulpritKind::fixed_point, number};
        const Vec2 wanted = fixed_points_[number];
        const double depth = domain_.depth(snapped(wanted));
        if (!(depth >= 0.0))
            refuse(FaultKind::outside, {self}, wanted,
                   "{1} lies outside the body {at}; put it inside or on the boundary");
        if (depth > 0.0 && depth < tolerances_.near_miss)
            refuse(FaultKind::too_near, {self}, wanted,
                   "{1} lies within " + number_text(depth) +
                       " m of the boundary {at}; put it on the boundary or farther away");
        const int point = point_at(wanted);
        graph_.fixed_points.push_back(point);
        for (int other = 0; other < point; ++other)
            if (distance(at(other), at(point)) < tolerances_.near_miss)
                refuse(FaultKind::too_near, {self, holder(other)}, wanted,
                       "{1} lies only " + number_text(distance(at(other), at(point))) +
                           " m from {2} {at}; put them at one place or farther apart");
        for (int i = 0; i < count(); ++i) {
            if (!is_placed(i) || start_or_stop(i, point))
                continue;
            const double gap = distance_to_segment(at(point), start(i), stop(i));
            if (gap <= tolerances_.same)
                add_cut(i, point);
            else if (gap < tolerances_.near_miss)
                refuse(FaultKind::too_near, {self, owner(i)}, wanted,
                       "{1} lies within " + number_text(gap) +
                           " m of {2} {at}; move it farther away");
        }
    }

    bool start_or_stop(int i, int point) const {
        return cuts_[i][0].point == point || cuts_[i][1].point == point;
    }

    // Whose point it is: a fracture's, or else a fixed one.
    Culprit holder(int point) const {
        for (int i = 0; i < count(); ++i)
            for (const Cut& cut : cuts_[i])
                if (cut.point == point)
                    return owner(i);
        const auto& fixed = graph_.fixed_points;
        const auto found = std::find(fixed.begin(), fixed.end(), point);
        return {CulpritKind::fixed_point, static_cast<int>(found - fixed.begin())};
    }

    void check_depth(int i, int point) const {
        if (segments_[i].old_cell < 0 && !graph_.points[point].on_boundary &&
            !domain_.is_deeper(at(point), tolerances_.near_miss) &&
            domain_.depth(at(point)) < tolerances_.near_miss)
            refuse(FaultKind::too_near, {owner(i)}, at(point),
                   "{1} comes within " + number_text(domain_.depth(at(point))) +
                       " m of the boundary {at}; let it end on the boundary or farther away from "
                       "it");
    }

    bool boxes_apart(int i, int j) const {
        const double gap = tolerances_.near_miss;
        const Vec2 a = start(i), b = stop(i), c = start(j), d = stop(j);
        return std::max(a.x, b.x) + gap < std::min(c.x, d.x) ||
               std::max(c.x, d.x) + gap < std::min(a.x, b.x) ||
               std::max(a.y, b.y) + gap < std::min(c.y, d.y) ||
               std::max(c.y, d.y) + gap < std::min(a.y, b.y);
    }

    // Every two segments whose boxes are near to each other, the earlier one first.
    void intersect_all() {
        BoxGrid grid(box_, segments_.size());
        const Vec2 gap = {tolerances_.near_miss, tolerances_.near_miss};
        for (int j = 0; j < count(); ++j) {
            if (!is_placed(j))
                continue;
            const Vec2 a = start(j), b = stop(j);
            const Vec2 low = {std::min(a.x, b.x), std::min(a.y, b.y)};
            const Vec2 high = {std::max(a.x, b.x), std::max(a.y, b.y)};
            for (int i : grid.candidates(low - gap, high + gap))
                intersect(i, j);
            grid.add(j, low, high);
        }
    }

    void intersect(int i, int j) {
        if (boxes_apart(i, j))
            return;
        if (segments_[i].old_cell >= 0 && segments_[j].old_cell >= 0)
            return; // they were meshed before
        const std::array<int, 2> p = {cuts_[i][0].point, cuts_[i][1].point};
        const std::array<int, 2> q = {cuts_[j][0].point, cuts_[j][1].point};
        if (p[0] == q[0] || p[0] == q[1] || p[1] == q[0] || p[1] == q[1])
            return; // an angle between them is checked for all edges at a point
        int touches = 0;
        for (int k = 0; k < 2; ++k) {
            touches += touch(i, p[k], j);
            touches += touch(j, q[k], i);
        }
        if (touches > 1)
            refuse(FaultKind::overlap, owners(i, j), at(p[0]),
                   pair_name(i, j) + " overlap {at}; leave one of them out or move it");
        if (touches == 1 || !segments_cross(start(i), stop(i), start(j), stop(j)))
            return;
        const Vec2 di = stop(i) - start(i), dj = stop(j) - start(j);
        const double t = cross(start(j) - start(i), dj) / cross(di, dj);
        const int point = point_at(along(start(i), stop(i), t));
        add_cut(i, point);
        add_cut(j, point);
    }

    // Does an end of segment i lie on segment j? Then it cuts j.
    int touch(int i, int point, int j) {
        const double gap = distance_to_segment(at(point), start(j), stop(j));
        if (gap <= tolerances_.same) {
            add_cut(j, point);
            return 1;
        }
        if (gap < tolerances_.near_miss)
            refuse(FaultKind::too_near, owners(i, j), at(point),
                   pair_name(i, j) + " come within " + number_text(gap) +
                       " m {at} without meeting; let them meet or move them apart");
        return 0;
    }

    void add_cut(int i, int point) {
        for (const Cut& cut : cuts_[i])
            if (cut.point == point)
                return;
        cuts_[i].push_back({distance(start(i), at(point)), point});
    }

    // Make the edges of a segment, with arc lengths measured on the whole segment.
    void divide(int i) {
        if (!is_placed(i))
            return;
        const Segment& segment = segments_[i];
        const double whole = distance(segment.end[0], segment.end[1]);
        const auto arc_length = [&](int point) {
            const double share = distance(segment.end[0], at(point)) / whole;
            return segment.s[0] + share * (segment.s[1] - segment.s[0]);
        };
        std::vector<Cut> cuts = cuts_[i];
        std::sort(cuts.begin(), cuts.end(),
                  [](const Cut& a, const Cut& b) { return a.distance < b.distance; });
        for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
            const int p = cuts[k].point, q = cuts[k + 1].point;
            if (cuts.size() > 2 && distance(at(p), at(q)) < tolerances_.near_miss)
                refuse(FaultKind::too_near, {owner(i)}, at(p),
                       "{1} meets others at points only " + number_text(distance(at(p), at(q))) +
                           " m apart {at}; move one of them");
            GraphEdge edge;
            edge.fracture = segment.fracture;
            edge.point = {p, q};
            edge.s = {arc_length(p), arc_length(q)};
            if (k == 0 && at(p) == segment.end[0])
                edge.s[0] = segment.s[0];
            if (k + 2 == cuts.size() && at(q) == segment.end[1])
                edge.s[1] = segment.s[1];
            edge.segment = i;
            edge.old_cell = segment.old_cell;
            graph_.edges.push_back(edge);
        }
    }

    // Edges at a point must be far enough apart to fit triangles between them.
    void check_angles() const {
        std::vector<std::vector<int>> star(graph_.points.size());
        for (int e = 0; e < static_cast<int>(graph_.edges.size()); ++e)
            for (int p : graph_.edges[e].point)
                star[p].push_back(e);
        const auto direction = [&](int e, int p) {
            const GraphEdge& edge = graph_.edges[e];
            return at(edge.point[0] == p ? edge.point[1] : edge.point[0]) - at(p);
        };
        for (int p = 0; p < static_cast<int>(star.size()); ++p) {
            for (std::size_t k = 0; k < star[p].size(); ++k) {
                const int e = star[p][k];
                check_angle_with_boundary(e, p, direction(e, p));
                for (std::size_t l = 0; l < k; ++l) {
                    const int f = star[p][l];
                    if (graph_.edges[e].old_cell >= 0 && graph_.edges[f].old_cell >= 0)
                        continue;
                    const double angle = angle_between(direction(e, p), direction(f, p));
                    if (angle < tolerances_.angle)
                        refuse_angle(graph_.edges[f], graph_.edges[e], at(p), angle);
                }
            }
        }
    }

    // Two edges at a point have too small an angle, or none, between them.
    [[noreturn]] void refuse_angle(const GraphEdge& a, const GraphEdge& b, Vec2 place,
                                   double angle) const {
        const std::vector<Culprit> who = owners(a.segment, b.segment);
        const std::string names = pair_name(a.segment, b.segment);
        if (angle < 1e-6)
            refuse(FaultKind::overlap, who, place,
                   names + " overlap {at}; leave one of them out or move it");
        refuse(FaultKind::angle, who, place,
               names + " meet at too small an angle {at}: " + number_text(degrees(angle)) +
                   " degrees; at least " + number_text(degrees(tolerances_.angle)) + " are needed");
    }

    static double degrees(double angle) { return angle * 180.0 / 3.14159265358979323846; }

    void check_angle_with_boundary(int e, int p, Vec2 direction) const {
        const GraphEdge& edge = graph_.edges[e];
        if (!graph_.points[p].on_boundary || edge.old_cell >= 0)
            return;
        if (domain_.angle_with_boundary(at(p), direction) < tolerances_.angle)
            refuse(FaultKind::angle, {fracture_culprit(edge.fracture)}, at(p),
                   "{1} meets the boundary at too small an angle {at}; at least " +
                       number_text(degrees(tolerances_.angle)) + " degrees are needed");
    }

    // Points on the boundary must be apart from each other and from the corners.
    void check_boundary() const {
        std::vector<int> on_boundary;
        for (int p = 0; p < static_cast<int>(graph_.points.size()); ++p) {
            if (!graph_.points[p].on_boundary)
                continue;
            for (int k = 0; k < domain_.edge_count(); ++k)
                check_gap(p, domain_.corners()[k], [&] { return Culprit{CulpritKind::corner, k}; });
            for (int other : on_boundary)
                check_gap(p, at(other), [&] { return holder(other); });
            on_boundary.push_back(p);
        }
    }

    template <typename Whose> void check_gap(int point, Vec2 other, Whose&& whose) const {
        const double gap = distance(other, at(point));
        if (gap > 0.0 && gap < tolerances_.near_miss)
            refuse(FaultKind::too_near, {holder(point), whose()}, at(point),
                   "{1} meets the boundary {at} only " + number_text(gap) +
                       " m from {2}; put them at one place or farther apart");
    }

    const std::vector<Segment>& segments_;
    const std::vector<Vec2>& fixed_points_;
    const Domain& domain_;
    const Rectangle box_;
    const bool clip_;
    const Tolerances tolerances_;
    std::vector<std::vector<Cut>> cuts_; // by segment; the first two are its ends
    BoxGrid point_grid_;
    Graph graph_;
};

} // namespace

Graph build_graph(const std::vector<Segment>& segments, const std::vector<Vec2>& fixed_points,
                  const Domain& domain, bool clip, const Tolerances& tolerances) {
    return GraphBuilder(segments, fixed_points, domain, clip, tolerances).build();
}

} // namespace cpp_mesh
