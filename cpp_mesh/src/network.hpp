// Fracture polylines, and the planar graph that they form where they cross, touch and meet the
// boundary.
#ifndef CPP_MESH_NETWORK_HPP
#define CPP_MESH_NETWORK_HPP

#include "domain.hpp"
#include "geometry.hpp"

#include <array>
#include <vector>

namespace cpp_mesh {

// Polylines: vertices of fracture f are first[f] .. first[f+1]-1; s_start is the arc length of the
// first.
struct Network {
    std::vector<int> first = {0};
    std::vector<Vec2> xy;
    std::vector<double> s_start;

    int size() const { return static_cast<int>(first.size()) - 1; }
};

// A straight piece of a fracture with the arc length of its ends [m]; old_cell is the fracture cell
// of the mesh before, which must not be divided, or -1.
struct Segment {
    int fracture = 0;
    std::array<Vec2, 2> end;
    std::array<double, 2> s = {0.0, 0.0};
    int old_cell = -1;
};

struct GraphPoint {
    Vec2 xy;
    bool on_boundary = false;
};

struct GraphEdge {
    int fracture = 0;
    std::array<int, 2> point = {-1, -1};
    std::array<double, 2> s = {0.0, 0.0};
    int segment = -1; // of the input
    int old_cell = -1;
};

// Edges meet only in points. Edges of a segment follow each other along it, segments keep their
// order.
struct Graph {
    std::vector<GraphPoint> points;
    std::vector<GraphEdge> edges;
    std::vector<std::array<int, 2>> segment_points; // ends of each segment; -1 if it was dropped
    std::vector<int> fixed_points;                  // the graph point of each fixed point
};

// Points nearer than `same` are one point; nearer than `near_miss` but not the same cannot be
// meshed.
struct Tolerances {
    double same = 0.0;
    double near_miss = 0.0;
    double angle = 0.0; // [rad]
};

Tolerances tolerances_for(const Rectangle& rectangle, double size);

std::vector<Segment> segments_of(const Network& network);

// What has been added at the ends of fractures; everything else must be as it was.
std::vector<Segment> grown_segments(const Network& before, const Network& after);

// With `clip`, what lies outside the rectangle is dropped; else it is refused. The fixed points
// become points of the graph too, of their own or on the edges on which they lie.
Graph build_graph(const std::vector<Segment>& segments, const std::vector<Vec2>& fixed_points,
                  const Domain& domain, bool clip, const Tolerances& tolerances);

} // namespace cpp_mesh

#endif
