#include "lone_sectors.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace cpp_mesh {

namespace {

std::pair<int, int> ordered(int a, int b) {
    return {std::min(a, b), std::max(a, b)};
}

class Divider {
public:
    Divider(PlaneMesh& mesh, int first_cell) : mesh_(mesh), first_cell_(first_cell) {
        for (const FractureCell& cell : mesh.fracture_cells)
            fractures_.insert(ordered(cell.node[0], cell.node[1]));
    }

    void run() {
        for (bool found = true; found;) {
            found = false;
            const EdgeTable edges(mesh_.cells, static_cast<int>(mesh_.xy.size()));
            for (int c = first_cell_; c < static_cast<int>(mesh_.cells.size()) && !found; ++c) {
                for (int k = 0; k < 3 && !found; ++k) {
                    found = fills_sector(edges, c, k) && may_change(edges.across(c, (k + 1) % 3));
                    if (found)
                        divide(edges, c, (k + 1) % 3);
                }
            }
        }
    }

private:
    bool is_fracture(int c, int k) const {
        const Triangle& cell = mesh_.cells[c];
        return fractures_.count(ordered(cell[k], cell[(k + 1) % 3])) > 0;
    }

    // The two edges at corner k of a cell part it from its neighbours, one of them a fracture.
    bool fills_sector(const EdgeTable& edges, int c, int k) const {
        const int after = k, before = (k + 2) % 3;
        const bool wall = is_fracture(c, after), other_wall = is_fracture(c, before);
        return (wall || other_wall) && (wall || edges.across(c, after) < 0) &&
               (other_wall || edges.across(c, before) < 0);
    }

    bool may_change(int c) const { return c < 0 || c >= first_cell_; }

    // Halve edge k of a cell.
    void divide(const EdgeTable& edges, int c, int k) {
        const int a = mesh_.cells[c][k], b = mesh_.cells[c][(k + 1) % 3];
        const int middle = static_cast<int>(mesh_.xy.size());
        mesh_.xy.push_back(0.5 * (mesh_.xy[a] + mesh_.xy[b]));
        const int behind = edges.across(c, k);
        halve(c, a, b, middle);
        if (behind >= 0)
            halve(behind, b, a, middle);
        if (fractures_.erase(ordered(a, b)) == 0)
            return;
        fractures_.insert(ordered(a, middle));
        fractures_.insert(ordered(middle, b));
        halve_fracture_cell(a, b, middle);
    }

    // A cell whose boundary runs from a to b.
    void halve(int c, int a, int b, int middle) {
        Triangle rest = mesh_.cells[c];
        std::replace(mesh_.cells[c].begin(), mesh_.cells[c].end(), b, middle);
        std::replace(rest.begin(), rest.end(), a, middle);
        mesh_.cells.push_back(rest);
    }

    void halve_fracture_cell(int a, int b, int middle) {
        auto& cells = mesh_.fracture_cells;
        const auto cell = std::find_if(cells.begin(), cells.end(), [&](const FractureCell& f) {
            return ordered(f.node[0], f.node[1]) == ordered(a, b);
        });
        FractureCell rest = *cell;
        cell->node[1] = middle;
        rest.node[0] = middle;
        cell->s[1] = 0.5 * (cell->s[0] + cell->s[1]);
        rest.s[0] = cell->s[1];
        cells.insert(cell + 1, rest);
    }

    PlaneMesh& mesh_;
    const int first_cell_;
    std::set<std::pair<int, int>> fractures_; // edges, by their nodes
};

} // namespace

void divide_lone_sectors(PlaneMesh& mesh, int first_cell) {
    Divider(mesh, first_cell).run();
}

} // namespace cpp_mesh
