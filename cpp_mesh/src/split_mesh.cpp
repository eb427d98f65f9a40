#include "split_mesh.hpp"

#include "errors.hpp"

namespace cpp_mesh {

namespace {

class Splitter {
public:
    Splitter(const PlaneMesh& plane, const Domain& domain)
        : plane_(plane), domain_(domain), edges_(plane.cells, static_cast<int>(plane.xy.size())),
          point_of_node_(plane.xy.size(), -1) {}

    SplitMesh run() {
        mesh_.xy = plane_.xy;
        mesh_.cells = plane_.cells;
        mesh_.fracture_cells = plane_.fracture_cells;
        number_points();
        split_nodes();
        make_faces();
        find_kinds();
        return std::move(mesh_);
    }

private:
    int fracture_cell_count() const { return static_cast<int>(plane_.fracture_cells.size()); }

    void number_points() {
        for (int i = 0; i < fracture_cell_count(); ++i) {
            mesh_.fracture_cell_points.push_back({});
            for (int k = 0; k < 2; ++k) {
                const int node = plane_.fracture_cells[i].node[k];
                int& point = point_of_node_[node];
                if (point < 0) {
                    point = static_cast<int>(mesh_.points.size());
                    mesh_.points.emplace_back();
                    mesh_.points.back().xy = plane_.xy[node];
                    mesh_.points.back().plane_node = node;
                }
                mesh_.points[point].cells.push_back(i);
                mesh_.fracture_cell_points[i][k] = point;
            }
        }
    }

    // The fracture cell on the edge between two nodes, or -1.
    int fracture_cell_between(int a, int b) const {
        if (point_of_node_[a] < 0 || point_of_node_[b] < 0)
            return -1;
        for (int i : mesh_.points[point_of_node_[a]].cells) {
            const auto& node = plane_.fracture_cells[i].node;
            if ((node[0] == a && node[1] == b) || (node[0] == b && node[1] == a))
                return i;
        }
        return -1;
    }

    // Cells around a fracture point that reach each other without crossing a fracture share a copy
    // of its node; the first such sector keeps the node itself.
    void split_nodes() {
        for (FracturePoint& point : mesh_.points) {
            const int node = point.plane_node;
            std::vector<int> waiting(edges_.begin(node), edges_.end(node));
            point.copies = 0;
            while (!waiting.empty()) {
                std::vector<int> sector = {waiting.front()};
                waiting.erase(waiting.begin());
                for (std::size_t k = 0; k < sector.size(); ++k)
                    move_neighbours(node, sector[k], waiting, sector);
                if (point.copies++ > 0) {
                    for (int cell : sector)
                        std::replace(mesh_.cells[cell].begin(), mesh_.cells[cell].end(), node,
                                     static_cast<int>(mesh_.xy.size()));
                    mesh_.xy.push_back(plane_.xy[node]);
                }
            }
        }
    }

    void move_neighbours(int node, int cell, std::vector<int>& waiting,
                         std::vector<int>& sector) const {
        for (std::size_t k = 0; k < waiting.size();) {
            const int shared = shared_node(node, cell, waiting[k]);
            if (shared >= 0 && fracture_cell_between(node, shared) < 0) {
                sector.push_back(waiting[k]);
                waiting.erase(waiting.begin() + static_cast<std::ptrdiff_t>(k));
            } else {
                ++k;
            }
        }
    }

    // The other node that two cells around a node share, or -1.
    int shared_node(int node, int c, int d) const {
        for (int a : plane_.cells[c])
            for (int b : plane_.cells[d])
                if (a == b && a != node)
                    return a;
        return -1;
    }

    void make_faces() {
        const int n_cells = static_cast<int>(plane_.cells.size());
        mesh_.cell_faces.assign(n_cells, {-1, -1, -1});
        mesh_.fracture_cell_faces.assign(fracture_cell_count(), {-1, -1});
        for (int c = 0; c < n_cells; ++c) {
            for (int k = 0; k < 3; ++k) {
                if (mesh_.cell_faces[c][k] >= 0)
                    continue;
                const int a = plane_.cells[c][k], b = plane_.cells[c][(k + 1) % 3];
                const int face_index = static_cast<int>(mesh_.faces.size());
                Face face;
                face.node = {mesh_.cells[c][k], mesh_.cells[c][(k + 1) % 3]};
                face.cell[0] = c;
                face.fracture_cell = fracture_cell_between(a, b);
                const int neighbour = edges_.cell(b, a);
                if (face.fracture_cell >= 0) {
                    // The cell on the left of a -> b has the fracture on its left side when both
                    // run alike; left of the fracture is side -.
                    const FractureCell& cell = plane_.fracture_cells[face.fracture_cell];
                    const int side = cell.node[0] == a ? 1 : 0;
                    mesh_.fracture_cell_faces[face.fracture_cell][side] = face_index;
                } else if (neighbour >= 0) {
                    face.cell[1] = neighbour;
                    for (int l = 0; l < 3; ++l)
                        if (plane_.cells[neighbour][l] == b)
                            mesh_.cell_faces[neighbour][l] = face_index;
                } else {
                    face.side = domain_.common_side(plane_.xy[a], plane_.xy[b]);
                }
                mesh_.cell_faces[c][k] = face_index;
                mesh_.faces.push_back(face);
            }
        }
    }

    bool is_on_boundary(Vec2 p) const { return domain_.is_on_boundary(p); }

    // Where a polyline begins or ends, or is cut by the boundary, its chain of cells breaks.
    bool starts_chain(int i) const { return i == 0 || !follow(i - 1, i); }
    bool ends_chain(int i) const { return i + 1 == fracture_cell_count() || !follow(i, i + 1); }

    bool follow(int i, int j) const {
        const FractureCell& a = plane_.fracture_cells[i];
        const FractureCell& b = plane_.fracture_cells[j];
        return a.fracture == b.fracture && a.node[1] == b.node[0];
    }

    void find_kinds() {
        std::vector<int> ends(mesh_.points.size(), 0);
        for (int i = 0; i < fracture_cell_count(); ++i) {
            ends[mesh_.fracture_cell_points[i][0]] += starts_chain(i);
            ends[mesh_.fracture_cell_points[i][1]] += ends_chain(i);
        }
        for (std::size_t p = 0; p < mesh_.points.size(); ++p) {
            FracturePoint& point = mesh_.points[p];
            const int passing = (static_cast<int>(point.cells.size()) - ends[p]) / 2;
            if (is_on_boundary(point.xy))
                point.kind = PointKind::boundary;
            else if (ends[p] == 0 && passing == 1)
                point.kind = PointKind::interior;
            else if (ends[p] == 1 && passing == 0)
                point.kind = PointKind::tip;
            else if (ends[p] == 1 && passing == 1)
                point.kind = PointKind::joint_t;
            else if (ends[p] == 2 && passing == 0)
                point.kind = PointKind::corner;
            else
                point.kind = PointKind::joint_x;
        }
        for (int i = 0; i < fracture_cell_count(); ++i) {
            const auto& node = plane_.fracture_cells[i].node;
            const auto& point = mesh_.fracture_cell_points[i];
            if (starts_chain(i) && mesh_.points[point[0]].kind == PointKind::tip)
                add_tip(i, 1, point[0], node[0], node[1]);
            if (ends_chain(i) && mesh_.points[point[1]].kind == PointKind::tip)
                add_tip(i, 2, point[1], node[1], node[0]);
        }
    }

    void add_tip(int cell, int end, int point, int node, int behind) {
        Tip tip;
        tip.point = point;
        tip.node = node;
        tip.fracture = plane_.fracture_cells[cell].fracture;
        tip.end = end;
        tip.direction = unit(plane_.xy[node] - plane_.xy[behind]);
        for (const Rosette& rosette : plane_.rosettes)
            if (rosette.tip_node == node)
                tip.radius = rosette.radius;
        mesh_.tips.push_back(tip);
    }

    const PlaneMesh& plane_;
    const Domain& domain_;
    const EdgeTable edges_;
    std::vector<int> point_of_node_;
    SplitMesh mesh_;
};

} // namespace

SplitMesh split(const PlaneMesh& plane, const Domain& domain) {
    return Splitter(plane, domain).run();
}

} // namespace cpp_mesh
