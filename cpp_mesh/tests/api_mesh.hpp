// A mesh as a caller of the C API has it, for the tests: everything is read through the API, and
// what is derived from it (copies of nodes, areas, Euler characteristic) is counted here, not taken
// from the library.
#ifndef CPP_MESH_API_MESH_HPP
#define CPP_MESH_API_MESH_HPP

#include "cpp_mesh/c_api.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

using Point = std::array<double, 2>;
using Polyline = std::vector<Point>;

constexpr double pi = 3.14159265358979323846;

struct TestNetwork {
    std::vector<Polyline> fractures;
    std::vector<double> s_start;
    std::vector<int32_t> first;
    std::vector<double> xy;

    explicit TestNetwork(std::vector<Polyline> polylines)
        : fractures(std::move(polylines)), s_start(fractures.size(), 0.0) {}

    cm_network view() {
        first.assign(1, 0);
        xy.clear();
        for (const Polyline& line : fractures) {
            for (const Point& p : line)
                xy.insert(xy.end(), p.begin(), p.end());
            first.push_back(static_cast<int32_t>(xy.size() / 2));
        }
        return {static_cast<int32_t>(fractures.size()), first.data(), xy.data(), s_start.data()};
    }
};

inline cm_spec rectangle_spec(double width, double height, double size_fracture,
                              double size_boundary) {
    cm_spec spec{};
    spec.x_max = width;
    spec.y_max = height;
    spec.size_fracture = size_fracture;
    spec.size_boundary = size_boundary;
    return spec;
}

class ApiMesh {
public:
    ApiMesh() = default;
    ~ApiMesh() { cm_destroy(&handle); }
    ApiMesh(const ApiMesh&) = delete;
    ApiMesh& operator=(const ApiMesh&) = delete;

    bool create(const cm_spec& spec, TestNetwork network) {
        cm_destroy(&handle);
        const cm_network view = network.view();
        return read(cm_create(&spec, &view, &handle));
    }

    bool create_sized(const cm_spec& spec, TestNetwork network, const ApiMesh& old_mesh,
                      const std::vector<double>& cell_size) {
        cm_destroy(&handle);
        const cm_network view = network.view();
        return read(cm_create_sized(&spec, &view, old_mesh.handle,
                                    static_cast<int32_t>(cell_size.size()), cell_size.data(),
                                    &handle));
    }

    bool grow(const ApiMesh& old_mesh, TestNetwork network,
              const std::vector<double>& end_radius = {}) {
        cm_destroy(&handle);
        const cm_network view = network.view();
        return read(cm_grow(old_mesh.handle, &view,
                            end_radius.empty() ? nullptr : end_radius.data(), &handle));
    }

    bool move_tips(const ApiMesh& old_mesh, TestNetwork network, double reach = 1e9) {
        cm_destroy(&handle);
        const cm_network view = network.view();
        return read(cm_move_tips(old_mesh.handle, &view, reach, &handle));
    }

    bool remesh(const ApiMesh& old_mesh, TestNetwork network, const std::vector<Point>& centres,
                double radius, double size) {
        cm_destroy(&handle);
        const cm_network view = network.view();
        if (!read(cm_remesh(old_mesh.handle, &view, static_cast<int32_t>(centres.size()),
                            centres.empty() ? nullptr : centres[0].data(), radius, size, &handle)))
            return false;
        int32_t n_overlaps = 0;
        if (cm_map_sizes(handle, &n_overlaps) != 0)
            return false;
        cell_old.resize(counts.n_cells);
        overlap_first.resize(counts.n_cells + 1);
        overlap_cell.resize(n_overlaps);
        overlap_area.resize(n_overlaps);
        fcell_old.resize(counts.n_fracture_cells);
        return cm_map_copy(handle, cell_old.data(), overlap_first.data(), overlap_cell.data(),
                           overlap_area.data(), fcell_old.data()) == 0;
    }

    std::vector<char> bytes() const {
        int64_t n = 0;
        cm_store(handle, 0, nullptr, &n);
        std::vector<char> stored(static_cast<std::size_t>(n));
        cm_store(handle, n, stored.data(), &n);
        return stored;
    }

    bool load(const std::vector<char>& stored) {
        cm_destroy(&handle);
        return read(cm_load(static_cast<int64_t>(stored.size()), stored.data(), &handle));
    }

    Point node(int i) const { return {xy[2 * i], xy[2 * i + 1]}; }
    Point point(int i) const { return {point_xy[2 * i], point_xy[2 * i + 1]}; }

    double area(int c) const {
        const Point a = node(cell_nodes[3 * c]), b = node(cell_nodes[3 * c + 1]),
                    d = node(cell_nodes[3 * c + 2]);
        return 0.5 * ((b[0] - a[0]) * (d[1] - a[1]) - (b[1] - a[1]) * (d[0] - a[0]));
    }

    Point centre(int c) const {
        Point p = {0.0, 0.0};
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < 2; ++i)
                p[i] += node(cell_nodes[3 * c + k])[i] / 3.0;
        return p;
    }

    // Edge of the equilateral triangle of the same area.
    double size(int c) const { return std::sqrt(4.0 / std::sqrt(3.0) * area(c)); }

    double total_area() const {
        double total = 0.0;
        for (int c = 0; c < counts.n_cells; ++c)
            total += area(c);
        return total;
    }

    bool all_positive() const {
        for (int c = 0; c < counts.n_cells; ++c)
            if (!(area(c) > 0.0))
                return false;
        return true;
    }

    // Edges are counted from the cells, not from the library's faces.
    int euler() const {
        std::set<std::array<int32_t, 2>> edges;
        for (int c = 0; c < counts.n_cells; ++c)
            for (int k = 0; k < 3; ++k) {
                const int32_t a = cell_nodes[3 * c + k], b = cell_nodes[3 * c + (k + 1) % 3];
                edges.insert({std::min(a, b), std::max(a, b)});
            }
        return counts.n_nodes - static_cast<int>(edges.size()) + counts.n_cells;
    }

    // Nodes at a place.
    int copies(Point p) const {
        int n = 0;
        for (int i = 0; i < counts.n_nodes; ++i)
            n += std::hypot(xy[2 * i] - p[0], xy[2 * i + 1] - p[1]) < 1e-9;
        return n;
    }

    // Kind of the fracture point at a place, -1 if there is none.
    int kind(Point p) const {
        for (int i = 0; i < counts.n_fracture_points; ++i)
            if (std::hypot(point_xy[2 * i] - p[0], point_xy[2 * i + 1] - p[1]) < 1e-9)
                return point_kind[i];
        return -1;
    }

    double fracture_length(int f) const {
        double sum = 0.0;
        for (int i = 0; i < counts.n_fracture_cells; ++i)
            if (fcell_fracture[i] == f) {
                const Point a = point(fcell_points[2 * i]), b = point(fcell_points[2 * i + 1]);
                sum += std::hypot(b[0] - a[0], b[1] - a[1]);
            }
        return sum;
    }

    // Smallest angle of all cells [degrees].
    double smallest_angle() const {
        double smallest = 180.0;
        for (int c = 0; c < counts.n_cells; ++c)
            for (int k = 0; k < 3; ++k) {
                const Point a = node(cell_nodes[3 * c + k]),
                            b = node(cell_nodes[3 * c + (k + 1) % 3]),
                            d = node(cell_nodes[3 * c + (k + 2) % 3]);
                const double u[2] = {b[0] - a[0], b[1] - a[1]}, v[2] = {d[0] - a[0], d[1] - a[1]};
                const double angle =
                    std::atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]);
                smallest = std::min(smallest, angle * 180.0 / pi);
            }
        return smallest;
    }

    // Each side of each fracture cell: its face has the cell's end points, and the face's only cell
    // lies to the right for side +, to the left for side -. Returns the number of faults.
    int side_faults() const {
        int faults = 0;
        for (int i = 0; i < counts.n_fracture_cells; ++i) {
            const Point a = point(fcell_points[2 * i]), b = point(fcell_points[2 * i + 1]);
            for (int side = 0; side < 2; ++side) {
                const int f = fcell_faces[2 * i + side], c = face_cells[2 * f];
                const Point p = node(face_nodes[2 * f]), q = node(face_nodes[2 * f + 1]);
                double centre[2] = {0.0, 0.0};
                bool has_p = false, has_q = false;
                for (int k = 0; k < 3; ++k) {
                    const int n = cell_nodes[3 * c + k];
                    has_p = has_p || n == face_nodes[2 * f];
                    has_q = has_q || n == face_nodes[2 * f + 1];
                    centre[0] += xy[2 * n] / 3.0;
                    centre[1] += xy[2 * n + 1] / 3.0;
                }
                const double left =
                    (b[0] - a[0]) * (centre[1] - a[1]) - (b[1] - a[1]) * (centre[0] - a[0]);
                const bool is_same = (p == a && q == b) || (p == b && q == a);
                faults += !(is_same && has_p && has_q && face_cells[2 * f + 1] == -1 &&
                            face_fracture_cell[f] == i && (side == 0 ? left < 0.0 : left > 0.0));
            }
        }
        return faults;
    }

    // Length of the boundary faces on a side.
    double side_length(int side) const {
        double sum = 0.0;
        for (int f = 0; f < counts.n_faces; ++f)
            if (face_side[f] == side) {
                const Point p = node(face_nodes[2 * f]), q = node(face_nodes[2 * f + 1]);
                sum += std::hypot(q[0] - p[0], q[1] - p[1]);
            }
        return sum;
    }

    int locate(Point p) const {
        int32_t cell = -2;
        cm_locate(handle, 1, p.data(), &cell);
        return cell;
    }

    cm_mesh* handle = nullptr;
    cm_counts counts{};
    std::vector<double> xy, fcell_s, point_xy, tip_direction, tip_radius, overlap_area;
    std::vector<int32_t> cell_nodes, cell_faces, face_nodes, face_cells, face_side,
        face_fracture_cell, fcell_fracture, fcell_points, fcell_faces, point_kind, point_first,
        point_cells, tip_point, tip_node, tip_fracture, tip_end, cell_old, overlap_first,
        overlap_cell, fcell_old;
    std::string error;

private:
    bool read(int status) {
        error = status == 0 ? "" : cm_last_error();
        if (status != 0 || cm_sizes(handle, &counts) != 0)
            return false;
        xy.resize(2 * counts.n_nodes);
        cell_nodes.resize(3 * counts.n_cells);
        cell_faces.resize(3 * counts.n_cells);
        face_nodes.resize(2 * counts.n_faces);
        face_cells.resize(2 * counts.n_faces);
        face_side.resize(counts.n_faces);
        face_fracture_cell.resize(counts.n_faces);
        fcell_fracture.resize(counts.n_fracture_cells);
        fcell_points.resize(2 * counts.n_fracture_cells);
        fcell_faces.resize(2 * counts.n_fracture_cells);
        fcell_s.resize(2 * counts.n_fracture_cells);
        point_xy.resize(2 * counts.n_fracture_points);
        point_kind.resize(counts.n_fracture_points);
        point_first.resize(counts.n_fracture_points + 1);
        point_cells.resize(counts.n_point_cells);
        tip_point.resize(counts.n_tips);
        tip_node.resize(counts.n_tips);
        tip_fracture.resize(counts.n_tips);
        tip_end.resize(counts.n_tips);
        tip_direction.resize(2 * counts.n_tips);
        tip_radius.resize(counts.n_tips);
        const cm_arrays arrays = {xy.data(),
                                  cell_nodes.data(),
                                  cell_faces.data(),
                                  face_nodes.data(),
                                  face_cells.data(),
                                  face_side.data(),
                                  face_fracture_cell.data(),
                                  fcell_fracture.data(),
                                  fcell_points.data(),
                                  fcell_faces.data(),
                                  fcell_s.data(),
                                  point_xy.data(),
                                  point_kind.data(),
                                  point_first.data(),
                                  point_cells.data(),
                                  tip_point.data(),
                                  tip_node.data(),
                                  tip_fracture.data(),
                                  tip_end.data(),
                                  tip_direction.data(),
                                  tip_radius.data()};
        return cm_copy(handle, &arrays) == 0;
    }
};

#endif
