// The body to be meshed: a rectangle or a polygon.
#ifndef CPP_MESH_DOMAIN_HPP
#define CPP_MESH_DOMAIN_HPP

#include "geometry.hpp"

#include <vector>

namespace cpp_mesh {

// Edge k of the outline runs from corner k to the next one, counter-clockwise. Coordinates on the
// sides of a rectangle are exact; a point lies on an edge of a polygon if it does so up to
// rounding.
class Domain {
public:
    Domain() = default;
    explicit Domain(const Rectangle& rectangle);
    // The side number of each edge is given. Throws MeshError if the polygon is not simple.
    Domain(std::vector<Vec2> corners, std::vector<int> edge_sides);

    bool is_rectangle() const { return is_rectangle_; }
    const Rectangle& box() const { return box_; } // the rectangle, or the box around the polygon
    const std::vector<Vec2>& corners() const { return corners_; }
    int edge_count() const { return static_cast<int>(corners_.size()); }
    Vec2 start(int edge) const { return corners_[edge]; }
    Vec2 stop(int edge) const { return corners_[(edge + 1) % corners_.size()]; }
    int side(int edge) const { return edge_sides_[edge]; }
    double area() const { return area_; }

    // Distance to the boundary: 0 on it, negative outside.
    double depth(Vec2 p) const;

    // Is that distance certainly larger than a given one? A quick answer for most points.
    bool is_deeper(Vec2 p, double depth) const {
        return distance(p, core_centre_) < core_radius_ - depth;
    }

    bool is_on_boundary(Vec2 p) const { return !is_deeper(p, 0.0) && depth(p) == 0.0; }

    // Does the point lie on the edge? Its ends belong to it.
    bool is_on_edge(Vec2 p, int edge) const;

    // Side on which both points lie, 0 if there is none.
    int common_side(Vec2 a, Vec2 b) const;

    // The point itself, or the nearest one of the boundary if that is within the tolerance.
    Vec2 snapped(Vec2 p, double tolerance) const;

    // Smallest angle between a direction and the edges at a point of the boundary [rad].
    double angle_with_boundary(Vec2 p, Vec2 direction) const;

    // Does the open segment between two points of the body, or of its boundary, leave the body?
    bool is_left_by(Vec2 a, Vec2 b) const;

    void check() const;

    // Every member in turn, to store or load it.
    template <typename Archive> void visit(Archive& archive) {
        archive(box_, is_rectangle_, corners_, edge_sides_, area_, core_centre_, core_radius_,
                rounding_);
    }

    // The corner nearest to a segment, of those that lie on no edge through its ends, -1: none.
    int corner_beside(Vec2 a, Vec2 b) const;

private:
    void find_core();
    bool contains(Vec2 p) const;

    Rectangle box_;
    bool is_rectangle_ = true;
    std::vector<Vec2> corners_;
    std::vector<int> edge_sides_;
    double area_ = 0.0;
    Vec2 core_centre_;          // of a disc within a polygon, about which no edge need be asked
    double core_radius_ = -1.0; // [m]
    double rounding_ = 0.0;     // points so near to the boundary lie on it [m]
};

} // namespace cpp_mesh

#endif
