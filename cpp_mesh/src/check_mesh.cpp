#include "check_mesh.hpp"

#include "errors.hpp"

#include <cstdlib>
#include <string>

namespace cpp_mesh {

namespace {

void require(bool condition, const std::string& what) {
    if (!condition)
        throw MeshError("the mesh is not valid: " + what);
}

// The areas are summed with the rounding errors of the sum kept aside (Neumaier 1974), else those
// of a hundred thousand cells would hide a gap.
void check_areas(const SplitMesh& mesh, const Domain& domain) {
    double total = 0.0, lost = 0.0;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const Triangle& cell = mesh.cells[c];
        const double area = 0.5 * twice_area(mesh.xy[cell[0]], mesh.xy[cell[1]], mesh.xy[cell[2]]);
        require(area > 0.0, "cell " + std::to_string(c + 1) + " has no positive area");
        const double sum = total + area;
        lost += total >= area ? (total - sum) + area : (area - sum) + total;
        total = sum;
    }
    require(std::abs(total + lost - domain.area()) <= 1e-12 * domain.area(),
            "the cells do not cover the body exactly once");
}

// Every face lies between cells that have its nodes, in opposite order.
void check_faces(const SplitMesh& mesh) {
    std::vector<int> uses(mesh.faces.size(), 0);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        for (int k = 0; k < 3; ++k) {
            const int f = mesh.cell_faces[c][k];
            require(f >= 0, "a cell lacks a face");
            const Face& face = mesh.faces[f];
            const int a = mesh.cells[c][k], b = mesh.cells[c][(k + 1) % 3];
            const int own = face.cell[0] == static_cast<int>(c) ? 0 : 1;
            require(face.cell[own] == static_cast<int>(c), "a cell and its face disagree");
            require(face.node[own] == a && face.node[1 - own] == b,
                    "neighbours do not share the nodes of their face");
            ++uses[f];
        }
    }
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
        const Face& face = mesh.faces[f];
        const bool is_inner = face.cell[1] >= 0;
        require(uses[f] == (is_inner ? 2 : 1), "a face has the wrong number of cells");
        require(is_inner != (face.side != 0 || face.fracture_cell >= 0),
                "a face must have two cells, or lie on the boundary or on a fracture");
    }
}

// A point inside where d edges meet becomes d nodes, one on the boundary d + 1; where it is not so,
// other fractures than those given are joined there, or some are not cut.
void require_cuts(const SplitMesh& mesh, const Domain& domain) {
    for (const FracturePoint& point : mesh.points) {
        const int edges = static_cast<int>(point.cells.size());
        if (point.copies == (domain.depth(point.xy) > 0.0 ? edges : edges + 1))
            continue;
        Fault fault{FaultKind::too_near, {}, point.xy, ""};
        for (const int cell : point.cells) {
            const int fracture = mesh.fracture_cells[cell].fracture;
            if (fault.culprits.empty() ||
                (fault.culprits.size() == 1 && fault.culprits.front().number != fracture))
                fault.culprits.push_back(fracture_culprit(fracture));
        }
        if (fault.culprits.empty())
            continue;
        fault.reason = fault.culprits.size() == 1
                           ? "{1} could not be cut open in the mesh {at}; move it away from what "
                             "it nearly touches there, or merge the two"
                           : "{1} and {2} could not be cut open in the mesh {at}; separate or "
                             "merge them";
        throw MeshError(fault);
    }
}

// Cutting along a graph with E edges and V points inside the body changes the Euler
// characteristic nodes - faces + cells from 1 to 1 + E - V, whatever the graph's form, as each edge
// becomes two and each point as many as require_cuts says.
void check_euler(const SplitMesh& mesh, const Domain& domain) {
    int inside = 0;
    for (const FracturePoint& point : mesh.points)
        inside += domain.depth(point.xy) > 0.0;
    const int expected = 1 + static_cast<int>(mesh.fracture_cells.size()) - inside;
    const int found = static_cast<int>(mesh.xy.size()) - static_cast<int>(mesh.faces.size()) +
                      static_cast<int>(mesh.cells.size());
    if (found == expected)
        return;
    require_cuts(mesh, domain);
    require(false, "it has " + std::to_string(std::abs(found - expected)) +
                       " cuts more or fewer than the fractures make (its Euler characteristic is " +
                       std::to_string(found) + ", not " + std::to_string(expected) +
                       "); the usual cause is fractures that nearly touch: separate or merge "
                       "them");
}

// Side + is on the right of the fracture, side - on its left.
void check_sides(const SplitMesh& mesh) {
    for (std::size_t i = 0; i < mesh.fracture_cells.size(); ++i) {
        const auto& point = mesh.fracture_cell_points[i];
        const Vec2 a = mesh.points[point[0]].xy, b = mesh.points[point[1]].xy;
        for (int side = 0; side < 2; ++side) {
            const int f = mesh.fracture_cell_faces[i][side];
            require(f >= 0, "a fracture cell lacks a side");
            const Triangle& cell = mesh.cells[mesh.faces[f].cell[0]];
            const Vec2 centre =
                (1.0 / 3.0) * (mesh.xy[cell[0]] + mesh.xy[cell[1]] + mesh.xy[cell[2]]);
            require((twice_area(a, b, centre) > 0.0) == (side == 1),
                    "a fracture cell has its sides exchanged");
        }
    }
    for (const Tip& tip : mesh.tips)
        require(mesh.points[tip.point].copies == 1, "a free tip was split");
}

// Length of the part of a segment inside the body; only rectangles are left by segments.
double length_inside(const Segment& segment, const Domain& domain) {
    if (!domain.is_rectangle())
        return distance(segment.end[0], segment.end[1]);
    const Rectangle& r = domain.box();
    double t_in = 0.0, t_out = 1.0;
    const Vec2 a = segment.end[0], d = segment.end[1] - segment.end[0];
    const auto keep = [&](double start, double speed, double low, double high) {
        if (speed == 0.0) {
            if (start < low || start > high)
                t_out = -1.0;
            return;
        }
        const double t_low = (low - start) / speed, t_high = (high - start) / speed;
        t_in = std::max(t_in, std::min(t_low, t_high));
        t_out = std::min(t_out, std::max(t_low, t_high));
    };
    keep(a.x, d.x, r.x_min, r.x_max);
    keep(a.y, d.y, r.y_min, r.y_max);
    return std::max(0.0, t_out - t_in) * length(d);
}

} // namespace

void check_mesh(const SplitMesh& mesh, const Domain& domain) {
    check_areas(mesh, domain);
    check_faces(mesh);
    check_euler(mesh, domain);
    check_sides(mesh);
}

void check_fracture_length(const std::vector<FractureCell>& cells, const std::vector<Vec2>& xy,
                           const Network& network, const Domain& domain,
                           const Tolerances& tolerances) {
    std::vector<double> wanted(network.size(), 0.0), found(network.size(), 0.0);
    for (const Segment& segment : segments_of(network))
        wanted[segment.fracture] += length_inside(segment, domain);
    for (const FractureCell& cell : cells)
        found[cell.fracture] += distance(xy[cell.node[0]], xy[cell.node[1]]);
    // Points within the tolerance of each other or of the boundary have been made one.
    const double moved = 4.0 * tolerances.same;
    for (int f = 0; f < network.size(); ++f)
        require(std::abs(found[f] - wanted[f]) <= 1e-10 * wanted[f] + moved,
                fracture_name(f) + " is " + number_text(found[f]) + " m long instead of " +
                    number_text(wanted[f]) + " m");
}

} // namespace cpp_mesh
