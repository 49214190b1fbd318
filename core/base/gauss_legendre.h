// Gauss-Legendre quadrature, used for every integral without a closed form.
#pragma once

#include <vector>

namespace hairbake {

/// Nodes in (-1, 1), ascending, and their weights (sum 2). Exact for polynomials up to degree 2 * count - 1.
struct Quadrature {
    std::vector<double> nodes, weights;
};

/// Returns `count` >= 1 nodes. Newton's method on the Legendre polynomial (Press et al., Numerical Recipes, section
/// 4.6); accurate to about 1e-15 for counts up to some thousands. Thread-safe.
Quadrature gauss_legendre(int count);

}  // namespace hairbake
