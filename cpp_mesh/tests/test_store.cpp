// A mesh from stored bytes is the same mesh: its arrays, where points lie in it, and what is made
// from it. Bytes that end early are refused.
#include "api_mesh.hpp"
#include "checks.hpp"

namespace {

TestNetwork cross(double longer) {
    return TestNetwork(
        {{{0.2, 0.5}, {0.8, 0.52}, {0.8 + longer, 0.52}}, {{0.5, 0.2}, {0.47, 0.7}}});
}

bool are_same(const ApiMesh& a, const ApiMesh& b) {
    return a.xy == b.xy && a.cell_nodes == b.cell_nodes && a.cell_faces == b.cell_faces &&
           a.face_cells == b.face_cells && a.face_side == b.face_side && a.fcell_s == b.fcell_s &&
           a.point_cells == b.point_cells && a.point_kind == b.point_kind &&
           a.tip_radius == b.tip_radius && a.fcell_faces == b.fcell_faces;
}

void same_mesh(Checks& checks) {
    ApiMesh made, loaded, longer, longer_of_loaded;
    checks.is_true(made.create(rectangle_spec(1.0, 1.0, 0.05, 0.2), cross(0.05)), made.error);
    checks.is_true(loaded.load(made.bytes()), loaded.error);
    checks.is_true(are_same(made, loaded), "the arrays are the same");
    checks.is_true(made.bytes() == loaded.bytes(), "so are the bytes");

    const std::vector<double> places = {0.1, 0.2, 0.45, 0.5, 0.99, 0.01, 1.5, 0.5};
    std::vector<int32_t> cells(4), cells_of_loaded(4);
    checks.is_true(cm_locate(made.handle, 4, places.data(), cells.data()) == 0 &&
                       cm_locate(loaded.handle, 4, places.data(), cells_of_loaded.data()) == 0 &&
                       cells == cells_of_loaded,
                   "points lie in the same cells");

    TestNetwork grown = cross(0.05);
    grown.fractures[0].push_back({0.9, 0.53});
    checks.is_true(longer.remesh(made, grown, {{0.9, 0.53}}, 0.1, 0.05), longer.error);
    checks.is_true(longer_of_loaded.remesh(loaded, grown, {{0.9, 0.53}}, 0.1, 0.05),
                   longer_of_loaded.error);
    checks.is_true(are_same(longer, longer_of_loaded), "meshes made from it are the same");
}

void mesh_that_moves(Checks& checks) {
    ApiMesh made, loaded, moved, moved_loaded;
    cm_spec spec = rectangle_spec(1.0, 1.0, 0.05, 0.2);
    spec.is_window = 1;
    spec.rosette_sectors = 12;
    spec.rosette_radius = 0.02;
    checks.is_true(made.create(spec, cross(0.05)), made.error);
    checks.is_true(loaded.load(made.bytes()), loaded.error);
    checks.is_true(moved.move_tips(made, cross(0.055)), moved.error);
    checks.is_true(moved_loaded.move_tips(loaded, cross(0.055)), moved_loaded.error);
    checks.is_true(are_same(moved, moved_loaded), "its tips move in the same way");
}

void sizes_of_another_mesh(Checks& checks) {
    ApiMesh made, sized, loaded;
    const cm_spec spec = rectangle_spec(1.0, 1.0, 0.05, 0.2);
    checks.is_true(made.create(spec, cross(0.05)), made.error);
    const std::vector<double> sizes(static_cast<std::size_t>(made.counts.n_cells), 0.07);
    checks.is_true(sized.create_sized(spec, cross(0.05), made, sizes), sized.error);
    checks.is_true(loaded.load(sized.bytes()), loaded.error);
    checks.is_true(sized.bytes() == loaded.bytes(), "with its wanted sizes");
}

void short_bytes(Checks& checks) {
    ApiMesh made, loaded;
    checks.is_true(made.create(rectangle_spec(1.0, 1.0, 0.3, 0.5), cross(0.05)), made.error);
    const std::vector<char> bytes = made.bytes();
    bool all_refused = true;
    for (std::size_t n = 0; n < bytes.size(); n += 7)
        all_refused = all_refused && !loaded.load({bytes.begin(), bytes.begin() + n});
    checks.is_true(all_refused, "bytes that end early are refused");
}

} // namespace

int main() {
    Checks checks;
    same_mesh(checks);
    mesh_that_moves(checks);
    sizes_of_another_mesh(checks);
    short_bytes(checks);
    return checks.finish();
}
