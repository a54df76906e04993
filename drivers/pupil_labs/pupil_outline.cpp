#include "drivers/pupil_labs/pupil_outline.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>

namespace entoptic::drivers {

namespace {

constexpr int fit_points = 40;  // choice: 9 degrees apart, five unknowns
constexpr int quick_probes = 16;
constexpr int most_probes = 96;      // of the final test
constexpr int widest_search = 12;    // px along the normal, each way
constexpr float faintest_edge = 4;   // grey levels over two pixels: sensor noise after the low-pass is about 1
constexpr double edge_share = 0.35;  // an edge has at least this share of the outline's typical gradient
constexpr int sectors = 12;

struct Edge {
    Eigen::Vector2d t{1, 0}, normal{1, 0};  // where on the ellipse, and its normal there
    double offset = 0;                      // along the normal, px
    float gradient = 0;                     // grey levels over two pixels, dark inside
};

// Cosine and sine of `count` angles, evenly spread over the circle.
template <int count> const std::array<Eigen::Vector2d, count>& circle() {
    static const auto points = [] {
        std::array<Eigen::Vector2d, count> all;
        for (int i = 0; i < count; ++i) all[static_cast<std::size_t>(i)] = {std::cos(2 * M_PI * i / count), std::sin(2 * M_PI * i / count)};
        return all;
    }();
    return points;
}

// The steepest step from dark to bright near the ellipse at `t`; offsets near zero are preferred.
Edge edge_at(const SmoothImage& image, const Eigen::Vector2d& t, const Eigen::Vector2d& p, const Eigen::Vector2d& n, int reach) {
    std::array<float, 2 * widest_search + 3> profile;
    for (int k = 0; k < 2 * reach + 3; ++k) {
        const double d = k - reach - 1;
        profile[static_cast<std::size_t>(k)] = image.at(p.x() + d * n.x(), p.y() + d * n.y());
    }
    const auto gradient = [&](int d) {
        const auto k = static_cast<std::size_t>(d + reach + 1);
        return profile[k + 1] - profile[k - 1];
    };
    Edge best{t, n, 0, 0};
    float best_score = 0;
    int best_d = 0;
    for (int d = -reach; d <= reach; ++d) {
        const float far = static_cast<float>(d) / static_cast<float>(reach + 1);
        const float g = gradient(d), score = g * (1 - 0.5f * far * far);
        if (score > best_score) {
            best_score = score;
            best.gradient = g;
            best_d = d;
        }
    }
    best.offset = best_d;
    if (best_score > 0 && best_d > -reach && best_d < reach) {  // the peak of the parabola through three gradients
        const float before = gradient(best_d - 1), after = gradient(best_d + 1), bend = before - 2 * best.gradient + after;
        if (bend < 0) best.offset += std::clamp(0.5 * (before - after) / bend, -0.5, 0.5);
    }
    return best;
}

double typical_gradient(const std::array<Edge, fit_points>& edges, int count) {
    std::array<float, fit_points> g;
    for (int i = 0; i < count; ++i) g[static_cast<std::size_t>(i)] = edges[static_cast<std::size_t>(i)].gradient;
    const auto at = g.begin() + count * 7 / 10;
    std::nth_element(g.begin(), at, g.begin() + count);
    return *at;
}

double tukey(double x) { return std::abs(x) < 1 ? (1 - x * x) * (1 - x * x) : 0; }

// One weighted least-squares step of centre, half axes and angle towards the edges (Gauss-Newton on distances along the normals).
std::optional<Ellipse> moved(const Ellipse& e, const std::array<Edge, fit_points>& edges, int count, double tolerance) {
    using Vector5 = Eigen::Matrix<double, 5, 1>;
    Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
    Vector5 right = Vector5::Zero();
    const double typical = std::max<double>(faintest_edge, typical_gradient(edges, count));
    const EllipsePoints points(e);
    const double a = points.half_major(), b = points.half_minor();
    const Eigen::Vector2d along = points.turned(1, 0), across = points.turned(0, 1);
    const auto solve = [&](const Vector5& step) {
        normal.setZero();
        right.setZero();
        double used = 0;
        for (int i = 0; i < count; ++i) {
            const Edge& edge = edges[static_cast<std::size_t>(i)];
            if (edge.gradient < std::max<double>(faintest_edge, edge_share * typical)) continue;
            const Eigen::Vector2d& n = edge.normal;
            const double ct = edge.t.x(), st = edge.t.y(), on_major = along.dot(n), on_minor = across.dot(n);
            Vector5 row;
            row << n.x(), n.y(), ct * on_major, st * on_minor, a * ct * on_minor - b * st * on_major;
            const double weight = std::min(1.0, edge.gradient / typical) * tukey((edge.offset - row.dot(step)) / tolerance);
            normal += weight * row * row.transpose();
            right += weight * edge.offset * row;
            used += weight;
        }
        return used;
    };
    Vector5 step = Vector5::Zero();
    for (int round = 0; round < 3; ++round) {
        if (solve(step) < 6) return std::nullopt;
        // Damping: where edges say nothing of a direction (half an outline, a circle's angle) it stays as it is.
        normal.diagonal().array() += 0.02 * normal.trace() / 5;
        step = normal.ldlt().solve(right);
    }
    const double least = 0.5 * std::min(a, b);
    step.head<4>() = step.head<4>().cwiseMax(-least).cwiseMin(a);
    return ellipse_of(e.x + step[0], e.y + step[1], a + step[2], std::max(0.5, b + step[3]), e.angle + std::clamp(step[4], -0.5, 0.5));
}

bool plausible(const SmoothImage& image, const Ellipse& e, const OutlineLimits& limits) {
    return std::isfinite(e.x + e.y + e.major + e.minor + e.angle) && image.inside(e.x, e.y, 0) && e.major >= limits.min_diameter &&
           e.major <= limits.max_diameter && e.axis_ratio() >= limits.min_axis_ratio;
}

// Samples at three radii: how much of the inside is dark.
double dark_share(const SmoothImage& image, const Ellipse& e, float middle) {
    int dark = 0, all = 0;
    const EllipsePoints points(e);
    for (const double radius : {0.25, 0.5, 0.75}) {
        for (const Eigen::Vector2d& t : circle<12>()) {
            const Eigen::Vector2d p = points.point(t, radius);
            dark += image.at(p.x(), p.y()) < middle ? 1 : 0;
            ++all;
        }
    }
    return static_cast<double>(dark) / all;
}

OutlineQuality quality_of(const SmoothImage& image, const Ellipse& e) {
    const EllipsePoints points(e);
    const int every = e.perimeter() > 72 ? 1 : e.perimeter() > 36 ? 2 : 4, probes = most_probes / every;  // about a pixel apart
    const double reach = std::max(2.0, 0.15 * e.minor), far_reach = reach + std::max(2.0, 0.35 * e.minor),
                 tolerance = std::max(1.0, 0.04 * e.major);
    std::array<float, most_probes> steps, inner, outer, farther;
    std::array<Edge, most_probes> edges;
    for (int i = 0; i < probes; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const Eigen::Vector2d& t = circle<most_probes>()[static_cast<std::size_t>(every * i)];
        const Eigen::Vector2d p = points.point(t), n = points.normal(t), in = p - reach * n, out = p + reach * n,
                              far_out = p + far_reach * n;
        farther[k] = image.at(far_out.x(), far_out.y());
        inner[k] = image.at(in.x(), in.y());
        outer[k] = image.inside(out.x(), out.y(), 0.5) ? image.at(out.x(), out.y()) : inner[k];
        steps[k] = outer[k] - inner[k];
        edges[k] = image.inside(p.x(), p.y(), 2) ? edge_at(image, t, p, n, 3) : Edge{};
    }
    const auto median = [probes](std::array<float, most_probes> values) {
        std::nth_element(values.begin(), values.begin() + probes / 2, values.begin() + probes);
        return values[static_cast<std::size_t>(probes) / 2];
    };
    OutlineQuality q;
    const float step = median(steps);
    q.contrast = step;
    const float middle = median(inner) + 0.5f * step;
    q.plateau = static_cast<double>(std::count_if(farther.begin(), farther.begin() + probes, [&](float v) { return v > middle; })) / probes;
    double squares = 0;
    int supported = 0;
    std::bitset<sectors> covered;
    for (int i = 0; i < probes; ++i) {
        const Edge& edge = edges[static_cast<std::size_t>(i)];
        const float needed = std::max(faintest_edge, 0.3f * step);
        if (edge.gradient < needed || steps[static_cast<std::size_t>(i)] < needed || std::abs(edge.offset) > tolerance) continue;
        ++supported;
        squares += edge.offset * edge.offset;
        covered.set(static_cast<std::size_t>(sectors * i / probes));
    }
    q.support = static_cast<double>(supported) / probes;
    q.spread = static_cast<double>(covered.count()) / sectors;
    q.residual = supported > 0 ? std::sqrt(squares / supported) : tolerance;
    q.darkness = dark_share(image, e, middle);
    return q;
}

}  // namespace

double quick_support(const SmoothImage& image, const Ellipse& ellipse, float step) {
    int good = 0;
    const double reach = std::max(2.0, 0.2 * ellipse.minor);
    const EllipsePoints points(ellipse);
    for (const Eigen::Vector2d& t : circle<quick_probes>()) {
        const Eigen::Vector2d p = points.point(t), n = points.normal(t), in = p - reach * n, out = p + reach * n;
        good += image.at(out.x(), out.y()) - image.at(in.x(), in.y()) >= step ? 1 : 0;
    }
    return static_cast<double>(good) / quick_probes;
}

std::optional<Outline> refine_outline(const SmoothImage& image, const Ellipse& start, const OutlineLimits& limits) {
    Ellipse e = start;
    const int first = std::clamp(static_cast<int>(0.2 * (e.major + e.minor)), 3, widest_search);
    for (const int reach : {first, std::max(3, first / 2), 3, 3}) {
        const EllipsePoints points(e);
        std::array<Edge, fit_points> edges;
        int count = 0;
        for (const Eigen::Vector2d& t : circle<fit_points>()) {
            const Eigen::Vector2d p = points.point(t);
            if (image.inside(p.x(), p.y(), 2)) edges[static_cast<std::size_t>(count++)] = edge_at(image, t, p, points.normal(t), reach);
        }
        if (count < fit_points / 3) return std::nullopt;  // mostly outside the picture
        const auto next = moved(e, edges, count, std::max(1.2, 0.7 * reach));
        if (!next || !plausible(image, *next, limits)) return std::nullopt;
        e = *next;
    }
    return Outline{e, quality_of(image, e)};
}

}  // namespace entoptic::drivers
