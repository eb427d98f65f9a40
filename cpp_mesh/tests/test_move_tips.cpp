// Tips that move in a mesh: nodes follow, cells keep theirs, and what does not go is refused.
#include "api_mesh.hpp"
#include "checks.hpp"

namespace {

// A path through a window of 0.5 m, in pieces of 5 mm that turn a little; its last piece has the
// given share of that length and direction [rad].
constexpr double piece = 0.005;

TestNetwork path(double share, double direction) {
    Polyline line;
    double x = -0.013, y = 0.26;
    for (; x < 0.245; x += piece) {
        line.push_back({x, y});
        y -= 0.0002 + 0.00002 * std::sin(40.0 * x);
    }
    line.push_back({x, y});
    line.push_back(
        {x + share * piece * std::cos(direction), y + share * piece * std::sin(direction)});
    return TestNetwork({line, {{0.1, 0.4}, {0.4, 0.4}}});
}

Point start_of(const TestNetwork& network) {
    const Polyline& line = network.fractures[0];
    return line[line.size() - 2];
}

struct Window {
    std::vector<double> radius, focus;
    cm_spec spec = rectangle_spec(0.5, 0.5, piece, 0.1);

    explicit Window(double share) {
        radius = {0.0, 0.5 * share * piece, 0.0, 0.0};
        const Point tip = path(share, 0.0).fractures[0].back();
        focus = {tip[0], tip[1]};
        spec.is_window = 1;
        spec.rosette_sectors = 12;
        spec.rosette_radius = piece;
        spec.end_radius = radius.data();
        spec.is_rough = 1;
        spec.ring_slope = 0.5;
        spec.n_foci = 1;
        spec.foci = focus.data();
        spec.focus_slope = 0.4;
        spec.focus_size = 0.01;
    }
};

double length_of(const ApiMesh& mesh, int fracture) {
    double s = 0.0;
    for (int i = 0; i < mesh.counts.n_fracture_cells; ++i)
        if (mesh.fcell_fracture[i] == fracture)
            s += mesh.fcell_s[2 * i + 1] - mesh.fcell_s[2 * i];
    return s;
}

int tip_of(const ApiMesh& mesh, int fracture, int end) {
    for (int t = 0; t < mesh.counts.n_tips; ++t)
        if (mesh.tip_fracture[t] == fracture && mesh.tip_end[t] == end)
            return t;
    return -1;
}

// The moved mesh is one of the body and of the network as they are.
void check_moved(Checks& checks, const ApiMesh& made, const ApiMesh& moved, TestNetwork network,
                 double ratio, const std::string& name) {
    checks.is_true(moved.error.empty(), name + ": " + moved.error);
    if (!moved.error.empty())
        return;
    const Point tip = network.fractures[0].back(), start = start_of(network);
    const int t = tip_of(moved, 0, 2);
    checks.is_true(moved.node(moved.tip_node[t]) == tip, name + ": the tip");
    checks.is_close(moved.tip_radius[t], ratio * made.tip_radius[t], 1e-12 * piece,
                    name + ": rosette");
    const double reach = std::hypot(tip[0] - start[0], tip[1] - start[1]);
    checks.is_close(std::hypot(moved.tip_direction[2 * t] - (tip[0] - start[0]) / reach,
                               moved.tip_direction[2 * t + 1] - (tip[1] - start[1]) / reach),
                    0.0, 1e-12, name + ": direction");
    checks.is_true(moved.all_positive(), name + ": areas");
    checks.is_close(moved.total_area(), 0.25, 1e-12, name + ": area");
    checks.is_equal(moved.side_faults(), 0, name + ": sides");
    checks.is_true(moved.smallest_angle() >= std::min(17.0, made.smallest_angle()),
                   name + ": smallest angle " + std::to_string(moved.smallest_angle()));
    checks.is_close(length_of(moved, 0), moved.fracture_length(0), 1e-13,
                    name + ": arc length against length");
    checks.is_close(length_of(moved, 1), 0.3, 1e-13, name + ": the other fracture");
    checks.is_true(made.cell_nodes == moved.cell_nodes, name + ": cells");
    // Every cell around the tip has gone along: nodes on the ring are a radius away.
    for (int c = 0; c < moved.counts.n_cells; ++c)
        for (int k = 0; k < 3; ++k) {
            if (moved.cell_nodes[3 * c + k] != moved.tip_node[t])
                continue;
            for (int l : {1, 2}) {
                const Point p = moved.node(moved.cell_nodes[3 * c + (k + l) % 3]);
                checks.is_close(std::hypot(p[0] - tip[0], p[1] - tip[1]), moved.tip_radius[t],
                                1e-12, name + ": ring");
            }
        }
}

void along_and_about(Checks& checks) {
    for (double share : {1.0, 0.5, 0.25}) {
        Window window(share);
        ApiMesh made;
        checks.is_true(made.create(window.spec, path(share, 0.0)), made.error);
        for (double ratio : {0.6, 0.8, 1.0, 1.25, 1.5})
            for (double turn : {0.0, 0.15, -0.15}) {
                ApiMesh moved;
                const TestNetwork network = path(ratio * share, turn);
                moved.move_tips(made, network);
                check_moved(checks, made, moved, network, ratio,
                            "ratio " + std::to_string(ratio) + ", turn " + std::to_string(turn));
                if (ratio == 1.0 && turn == 0.0)
                    checks.is_true(moved.xy == made.xy, "nothing moves where no tip does");
            }
    }
}

// What is farther from the piece than the reach stays where it is, and what is nearer moves.
void only_within_reach(Checks& checks) {
    constexpr double reach = 6.0;
    Window window(0.5);
    ApiMesh made, moved;
    checks.is_true(made.create(window.spec, path(0.5, 0.0)), made.error);
    const TestNetwork network = path(1.0, 0.1);
    moved.move_tips(made, network, reach);
    check_moved(checks, made, moved, network, 2.0, "within reach");
    const Point start = start_of(network), tip = path(0.5, 0.0).fractures[0].back();
    int n_moved = 0;
    for (int v = 0; v < made.counts.n_nodes; ++v) {
        const Point p = made.node(v);
        if (moved.node(v) == p)
            continue;
        ++n_moved;
        const double x = std::min(std::max(p[0], start[0]), tip[0]);
        checks.is_true(std::hypot(p[0] - x, p[1] - start[1]) < reach * 0.5 * piece, "too far away");
    }
    checks.is_true(n_moved > 50 && n_moved < made.counts.n_nodes / 2,
                   std::to_string(n_moved) + " nodes have moved");
}

// A short piece between long ones makes cells of bad shape. They hardly change where the tip ahead
// of them moves, and do not hold it.
void past_bad_shapes(Checks& checks) {
    const auto network = [](double share) {
        return TestNetwork(
            {{{0.1, 0.25}, {0.3, 0.25}, {0.3004, 0.2503}, {0.3004 + share, 0.2503}}});
    };
    cm_spec spec = rectangle_spec(0.6, 0.5, 0.03, 0.1);
    spec.is_window = 1;
    spec.rosette_sectors = 12;
    spec.rosette_radius = 0.02;
    ApiMesh made;
    checks.is_true(made.create(spec, network(0.05)), made.error);
    checks.is_true(made.smallest_angle() < 5.0,
                   "bad shapes: " + std::to_string(made.smallest_angle()) + " degrees");
    for (double share : {0.045, 0.0501, 0.055}) {
        ApiMesh moved;
        checks.is_true(moved.move_tips(made, network(share)), moved.error);
        checks.is_true(moved.all_positive() && moved.smallest_angle() > 0.9 * made.smallest_angle(),
                       "bad shapes stay");
    }
}

void refusals(Checks& checks) {
    Window window(1.0);
    ApiMesh made, moved;
    checks.is_true(made.create(window.spec, path(1.0, 0.0)), made.error);
    checks.is_true(!moved.move_tips(made, path(0.2, 0.0)), "far back");
    checks.is_true(!moved.move_tips(made, path(1.0, 0.6)), "far about");
    TestNetwork longer = path(1.0, 0.0);
    longer.fractures[0].push_back({0.26, 0.25});
    checks.is_true(!moved.move_tips(made, longer), "another vertex");
    TestNetwork bent = path(1.0, 0.0);
    bent.fractures[0][20][1] += 1e-5;
    checks.is_true(!moved.move_tips(made, bent), "a vertex inside has moved");
    TestNetwork other = path(1.0, 0.0);
    other.fractures[1][1] = {0.41, 0.4};
    checks.is_true(!moved.move_tips(made, other), "the other end would be no fixed place");
    checks.is_true(moved.move_tips(made, path(0.9, 0.0)), "none of that is left behind");
    TestNetwork edge({{{0.1, 0.25}, {0.3, 0.25}, {0.6, 0.25}}});
    cm_spec plain = rectangle_spec(0.5, 0.5, 0.02, 0.1);
    plain.is_window = 1;
    plain.rosette_sectors = 12;
    plain.rosette_radius = 0.02;
    checks.is_true(made.create(plain, edge), made.error);
    edge.fractures[0][2] = {0.6, 0.26};
    checks.is_true(!moved.move_tips(made, edge), "where a fracture meets the edge");
}

} // namespace

int main() {
    Checks checks;
    along_and_about(checks);
    only_within_reach(checks);
    past_bad_shapes(checks);
    refusals(checks);
    return checks.finish();
}
