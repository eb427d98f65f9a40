// Points, segments and rectangles in the plane.
#ifndef CPP_MESH_GEOMETRY_HPP
#define CPP_MESH_GEOMETRY_HPP

#include <algorithm>
#include <array>
#include <cmath>

namespace cpp_mesh {

constexpr double pi = 3.14159265358979323846;

// Sizes and lengths that differ by this share are equal, whatever their rounding errors.
constexpr double tie_margin = 1e-9;

struct Vec2 {
    double x = 0.0;
    double y = 0.0;
};

inline Vec2 operator+(Vec2 a, Vec2 b) {
    return {a.x + b.x, a.y + b.y};
}
inline Vec2 operator-(Vec2 a, Vec2 b) {
    return {a.x - b.x, a.y - b.y};
}
inline Vec2 operator*(double c, Vec2 a) {
    return {c * a.x, c * a.y};
}
inline bool operator==(Vec2 a, Vec2 b) {
    return a.x == b.x && a.y == b.y;
}
inline bool operator!=(Vec2 a, Vec2 b) {
    return !(a == b);
}

inline double dot(Vec2 a, Vec2 b) {
    return a.x * b.x + a.y * b.y;
}
inline double cross(Vec2 a, Vec2 b) {
    return a.x * b.y - a.y * b.x;
}
inline double length(Vec2 a) {
    return std::sqrt(dot(a, a));
}
inline double distance(Vec2 a, Vec2 b) {
    return length(b - a);
}
inline Vec2 unit(Vec2 a) {
    return (1.0 / length(a)) * a;
}
inline Vec2 along(Vec2 a, Vec2 b, double t) {
    return a + t * (b - a);
}

// Turn by an angle [rad], counter-clockwise.
inline Vec2 turned(Vec2 a, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * a.x - s * a.y, s * a.x + c * a.y};
}

// Angle between two directions, 0 to pi [rad].
inline double angle_between(Vec2 a, Vec2 b) {
    return std::atan2(std::abs(cross(a, b)), dot(a, b));
}

// Where on the segment a-b (0 to 1) lies the point nearest to p.
inline double nearest_parameter(Vec2 p, Vec2 a, Vec2 b) {
    const Vec2 ab = b - a;
    const double square = dot(ab, ab);
    return square > 0.0 ? std::clamp(dot(p - a, ab) / square, 0.0, 1.0) : 0.0;
}

inline double distance_to_segment(Vec2 p, Vec2 a, Vec2 b) {
    return distance(p, along(a, b, nearest_parameter(p, a, b)));
}

// Twice the signed area of a triangle; positive if counter-clockwise.
inline double twice_area(Vec2 a, Vec2 b, Vec2 c) {
    return cross(b - a, c - a);
}

inline bool segments_cross(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
    return (twice_area(a, b, c) > 0.0) != (twice_area(a, b, d) > 0.0) &&
           (twice_area(c, d, a) > 0.0) != (twice_area(c, d, b) > 0.0);
}

inline double segment_distance(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
    if (segments_cross(a, b, c, d))
        return 0.0;
    return std::min({distance_to_segment(a, c, d), distance_to_segment(b, c, d),
                     distance_to_segment(c, a, b), distance_to_segment(d, a, b)});
}

// Sine of a triangle's smallest angle, a measure of its shape: negative if the triangle is
// inverted, at most sqrt(3)/2. The smallest angle lies between the two longest sides.
inline double sine_of_smallest_angle(Vec2 a, Vec2 b, Vec2 c) {
    const double ab = dot(b - a, b - a), bc = dot(c - b, c - b), ca = dot(a - c, a - c);
    const double shortest = std::min({ab, bc, ca});
    const double others = shortest == ab ? bc * ca : shortest == bc ? ca * ab : ab * bc;
    return others > 0.0 ? twice_area(a, b, c) / std::sqrt(others) : 0.0;
}

struct Rectangle {
    double x_min = 0.0, x_max = 0.0, y_min = 0.0, y_max = 0.0;

    double width() const { return x_max - x_min; }
    double height() const { return y_max - y_min; }
    double diagonal() const { return std::hypot(width(), height()); }
    double area() const { return width() * height(); }

    // Corners counter-clockwise from the lower left.
    std::array<Vec2, 4> corners() const {
        return {Vec2{x_min, y_min}, Vec2{x_max, y_min}, Vec2{x_max, y_max}, Vec2{x_min, y_max}};
    }

    // Distance to the nearest side; negative outside.
    double depth(Vec2 p) const {
        return std::min({p.x - x_min, x_max - p.x, p.y - y_min, y_max - p.y});
    }

    // Side on which both points lie: 1 left, 2 right, 3 bottom, 4 top, 0 none.
    int common_side(Vec2 a, Vec2 b) const {
        if (a.x == x_min && b.x == x_min)
            return 1;
        if (a.x == x_max && b.x == x_max)
            return 2;
        if (a.y == y_min && b.y == y_min)
            return 3;
        if (a.y == y_max && b.y == y_max)
            return 4;
        return 0;
    }
};

} // namespace cpp_mesh

#endif
