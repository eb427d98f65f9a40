#include "domain.hpp"

#include "errors.hpp"

#include <limits>
#include <utility>

namespace cpp_mesh {

namespace {

// Corners sharper than this leave no room for cells of fair shape.
constexpr double sharpest_corner = 3.0 * pi / 180.0;

// Relative to the largest coordinate; points put on an oblique edge miss it by rounding errors.
constexpr double relative_rounding = 1e-13;

// Relative to the box: corners and edges that are nearer than this are meant to be at one place.
constexpr double least_gap = 1e-9;

Culprit corner_culprit(int corner) {
    return {CulpritKind::corner, corner};
}

Culprit edge_culprit(int edge) {
    return {CulpritKind::edge, edge};
}

} // namespace

Domain::Domain(const Rectangle& rectangle)
    : box_(rectangle), edge_sides_({3, 2, 4, 1}), area_(rectangle.area()) {
    for (const Vec2& corner : rectangle.corners())
        corners_.push_back(corner);
    if (!(rectangle.width() > 0.0 && rectangle.height() > 0.0 &&
          std::isfinite(rectangle.diagonal())))
        throw MeshError({FaultKind::body, {}, {}, "the rectangle to be meshed has no area"});
}

Domain::Domain(std::vector<Vec2> corners, std::vector<int> edge_sides)
    : is_rectangle_(false), corners_(std::move(corners)), edge_sides_(std::move(edge_sides)) {
    if (edge_count() < 3)
        throw MeshError(
            {FaultKind::body,
             {},
             {},
             "the boundary needs at least 3 corners, not " + std::to_string(edge_count())});
    for (int k = 0; k < edge_count(); ++k)
        if (!std::isfinite(corners_[k].x) || !std::isfinite(corners_[k].y))
            throw MeshError({FaultKind::number, {corner_culprit(k)}, {}, "{1} is not a number"});
    const Vec2 first = corners_[0];
    Vec2 low = first, high = first;
    for (int k = 0; k < edge_count(); ++k) {
        low = {std::min(low.x, start(k).x), std::min(low.y, start(k).y)};
        high = {std::max(high.x, start(k).x), std::max(high.y, start(k).y)};
        area_ += 0.5 * cross(start(k) - first, stop(k) - first);
    }
    box_ = {low.x, high.x, low.y, high.y};
    rounding_ = relative_rounding * std::max({box_.diagonal(), std::abs(low.x), std::abs(low.y),
                                              std::abs(high.x), std::abs(high.y)});
    check();
    find_core();
}

// Around the middle of the box, which is that of a disc.
void Domain::find_core() {
    core_centre_ = {0.5 * (box_.x_min + box_.x_max), 0.5 * (box_.y_min + box_.y_max)};
    core_radius_ = depth(core_centre_) - 2.0 * rounding_;
}

// Edges meet only in the corners that they share, and run counter-clockwise.
void Domain::check() const {
    if (corners_.size() < 3 || edge_sides_.size() != corners_.size())
        throw MeshError({FaultKind::number, {}, {}, "corners and sides do not fit each other"});
    const double gap = std::max(rounding_, least_gap * box_.diagonal());
    for (int k = 0; k < edge_count(); ++k) {
        if (edge_sides_[k] < 1)
            throw MeshError({FaultKind::number,
                             {edge_culprit(k)},
                             {},
                             "{1} has the side number " + std::to_string(edge_sides_[k]) +
                                 "; it must be positive"});
        if (!(distance(start(k), stop(k)) > gap))
            throw MeshError({FaultKind::body,
                             {corner_culprit(k), corner_culprit((k + 1) % edge_count())},
                             start(k),
                             "{1} and {2} lie at one place {at}; give every corner once"});
    }
    for (int k = 0; k < edge_count(); ++k) {
        const int next = (k + 1) % edge_count();
        if (angle_between(start(k) - stop(k), stop(next) - start(next)) < sharpest_corner)
            throw MeshError({FaultKind::angle,
                             {corner_culprit(next)},
                             start(next),
                             "{1} {at} is too sharp to be meshed: less than " +
                                 number_text(sharpest_corner * 180.0 / pi) +
                                 " degrees lie between its edges"});
        for (int l = k + 2; l < edge_count(); ++l) {
            if (k == 0 && l + 1 == edge_count())
                continue; // neighbours
            if (!(segment_distance(start(k), stop(k), start(l), stop(l)) > gap))
                throw MeshError({FaultKind::body,
                                 {edge_culprit(k), edge_culprit(l)},
                                 {},
                                 "{1} and {2} meet, but edges may meet only at a corner that they "
                                 "share (edge k runs from corner k to the next one)"});
        }
    }
    if (!(area_ > 0.0))
        throw MeshError({FaultKind::body,
                         {},
                         {},
                         "the corners of the boundary must be given counter-clockwise"});
}

// A ray to the right meets the outline an odd number of times (Shimrat 1962).
bool Domain::contains(Vec2 p) const {
    bool is_inside = false;
    for (int k = 0; k < edge_count(); ++k) {
        const Vec2 a = start(k), b = stop(k);
        if ((a.y > p.y) == (b.y > p.y))
            continue;
        const bool is_left_of_upward_edge = twice_area(a, b, p) > 0.0;
        if (is_left_of_upward_edge == (b.y > a.y))
            is_inside = !is_inside;
    }
    return is_inside;
}

double Domain::depth(Vec2 p) const {
    if (is_rectangle_)
        return box_.depth(p);
    double nearest = std::numeric_limits<double>::max();
    for (int k = 0; k < edge_count(); ++k)
        nearest = std::min(nearest, distance_to_segment(p, start(k), stop(k)));
    if (nearest <= rounding_)
        return 0.0;
    return contains(p) ? nearest : -nearest;
}

bool Domain::is_on_edge(Vec2 p, int edge) const {
    const Vec2 a = start(edge), b = stop(edge);
    if (!is_rectangle_)
        return distance_to_segment(p, a, b) <= rounding_;
    return p.x >= std::min(a.x, b.x) && p.x <= std::max(a.x, b.x) && p.y >= std::min(a.y, b.y) &&
           p.y <= std::max(a.y, b.y);
}

int Domain::common_side(Vec2 a, Vec2 b) const {
    if (is_rectangle_)
        return box_.common_side(a, b);
    if (is_deeper(a, 0.0) || is_deeper(b, 0.0))
        return 0;
    for (int k = 0; k < edge_count(); ++k)
        if (is_on_edge(a, k) && is_on_edge(b, k))
            return side(k);
    return 0;
}

Vec2 Domain::snapped(Vec2 p, double tolerance) const {
    if (is_deeper(p, tolerance))
        return p;
    if (is_rectangle_) {
        const auto snap = [tolerance](double& coordinate, double side) {
            if (std::abs(coordinate - side) <= tolerance)
                coordinate = side;
        };
        snap(p.x, box_.x_min);
        snap(p.x, box_.x_max);
        snap(p.y, box_.y_min);
        snap(p.y, box_.y_max);
        return p;
    }
    for (const Vec2& corner : corners_)
        if (distance(corner, p) <= tolerance)
            return corner;
    Vec2 nearest = p;
    double gap = tolerance;
    for (int k = 0; k < edge_count(); ++k) {
        const Vec2 foot = along(start(k), stop(k), nearest_parameter(p, start(k), stop(k)));
        if (distance(p, foot) <= gap && !is_on_edge(p, k)) {
            nearest = foot;
            gap = distance(p, foot);
        }
    }
    return nearest;
}

double Domain::angle_with_boundary(Vec2 p, Vec2 direction) const {
    double smallest = pi;
    for (int k = 0; k < edge_count(); ++k)
        if (is_on_edge(p, k))
            for (const Vec2& end : {start(k), stop(k)})
                if (distance(end, p) > rounding_)
                    smallest = std::min(smallest, angle_between(end - p, direction));
    return smallest;
}

bool Domain::is_left_by(Vec2 a, Vec2 b) const {
    if (is_deeper(a, 0.0) && is_deeper(b, 0.0))
        return false;
    if (depth(a) < 0.0 || depth(b) < 0.0)
        return true;
    if (is_rectangle_)
        return false;
    for (int k = 0; k < edge_count(); ++k)
        if (!is_on_edge(a, k) && !is_on_edge(b, k) && segments_cross(a, b, start(k), stop(k)))
            return true;
    return depth(0.5 * (a + b)) < 0.0;
}

int Domain::corner_beside(Vec2 a, Vec2 b) const {
    int nearest = -1;
    for (int k = 0; k < edge_count(); ++k) {
        const int previous = (k + edge_count() - 1) % edge_count();
        if (is_on_edge(a, k) || is_on_edge(b, k) || is_on_edge(a, previous) ||
            is_on_edge(b, previous))
            continue;
        if (nearest < 0 ||
            distance_to_segment(corners_[k], a, b) < distance_to_segment(corners_[nearest], a, b))
            nearest = k;
    }
    return nearest;
}

} // namespace cpp_mesh
