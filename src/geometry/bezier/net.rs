//! The 16 control values of a bicubic polynomial over a rectangle: values, slopes, halves and parts.

/// Control values; `net[j][i]` belongs to `B_i(u) B_j(v)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Net(pub [[f64; 4]; 4]);

/// The cubic Bernstein polynomials.
pub(super) fn bernstein(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
}

/// Their derivatives.
fn bernstein_slope(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t]
}

/// Cuts a net in half.
pub(super) type Split = fn(&Net) -> (Net, Net);

fn dot(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])
}

/// The control values of a cubic over its halves (de Casteljau).
fn halves([a, b, c, d]: [f64; 4]) -> ([f64; 4], [f64; 4]) {
    let (ab, bc, cd) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + d));
    let (abc, bcd) = (0.5 * (ab + bc), 0.5 * (bc + cd));
    let middle = 0.5 * (abc + bcd);
    ([a, ab, abc, middle], [middle, bcd, cd, d])
}

/// The control values of a cubic over `low..=high`: its blossom at `low` and `high`.
fn part(c: [f64; 4], low: f64, high: f64) -> [f64; 4] {
    let mix = |a: f64, b: f64, t: f64| a * (1.0 - t) + b * t;
    let step = |t: f64| [mix(c[0], c[1], t), mix(c[1], c[2], t), mix(c[2], c[3], t)];
    let two = |x: [f64; 3], t: f64| [mix(x[0], x[1], t), mix(x[1], x[2], t)];
    let (l, h) = (step(low), step(high));
    let (ll, lh, hh) = (two(l, low), two(l, high), two(h, high));
    [mix(ll[0], ll[1], low), mix(ll[0], ll[1], high), mix(lh[0], lh[1], high), mix(hh[0], hh[1], high)]
}

impl Net {
    fn transposed(&self) -> Self {
        Self(std::array::from_fn(|j| std::array::from_fn(|i| self.0[i][j])))
    }

    /// Value and derivatives along u and v.
    pub fn value_and_slopes(&self, u: f64, v: f64) -> (f64, f64, f64) {
        let (bu, su, bv, sv) = (bernstein(u), bernstein_slope(u), bernstein(v), bernstein_slope(v));
        let rows = self.0.map(|row| dot(&row, &bu));
        let slopes = self.0.map(|row| dot(&row, &su));
        (dot(&rows, &bv), dot(&slopes, &bv), dot(&rows, &sv))
    }

    /// Derivatives along u and v.
    pub fn slopes(&self, u: f64, v: f64) -> (f64, f64) {
        let (_, along_u, along_v) = self.value_and_slopes(u, v);
        (along_u, along_v)
    }

    /// Derivatives at the rectangle's centre, for each rectangle.
    pub fn slopes_at_centre(&self) -> (f64, f64) {
        const B: [f64; 4] = [0.125, 0.375, 0.375, 0.125];
        const S: [f64; 4] = [-0.75, -0.75, 0.75, 0.75];
        let rows = self.0.map(|row| dot(&row, &B));
        let slopes = self.0.map(|row| dot(&row, &S));
        (dot(&slopes, &B), dot(&rows, &S))
    }

    /// Halves along u.
    pub fn split_u(&self) -> (Self, Self) {
        let parts = self.0.map(halves);
        (Self(parts.map(|p| p.0)), Self(parts.map(|p| p.1)))
    }

    /// Halves along v.
    pub fn split_v(&self) -> (Self, Self) {
        let (low, high) = self.transposed().split_u();
        (low.transposed(), high.transposed())
    }

    /// The same polynomial over a part of the rectangle.
    pub fn part(&self, rect: &Rect) -> Self {
        let along_u = Self(self.0.map(|row| part(row, rect.u.0, rect.u.1))).transposed();
        Self(along_u.0.map(|column| part(column, rect.v.0, rect.v.1))).transposed()
    }

    /// Least and greatest control value: between them lies every value.
    pub fn range(&self) -> (f64, f64) {
        range(self.0.as_flattened())
    }

    /// Greatest distances between neighbouring control values along u and v; the derivatives are at most three times
    /// those.
    pub fn strides(&self) -> (f64, f64) {
        let (mut u, mut v) = (0.0_f64, 0.0_f64);
        for j in 0..4 {
            for i in 0..3 {
                u = u.max((self.0[j][i + 1] - self.0[j][i]).abs());
                v = v.max((self.0[i + 1][j] - self.0[i][j]).abs());
            }
        }
        (u, v)
    }

    /// `a * self + b * other`
    pub fn combine(&self, a: f64, b: f64, other: &Self) -> Self {
        Self(std::array::from_fn(|j| std::array::from_fn(|i| a * self.0[j][i] + b * other.0[j][i])))
    }

    /// Least and greatest control value of the derivative along u.
    pub fn slope_range_u(&self) -> (f64, f64) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for row in &self.0 {
            for i in 0..3 {
                let slope = 3.0 * (row[i + 1] - row[i]);
                (low, high) = (least(low, slope), most(high, slope));
            }
        }
        (low, high)
    }

    /// Least and greatest control value of the derivative along v.
    pub fn slope_range_v(&self) -> (f64, f64) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for j in 0..3 {
            for i in 0..4 {
                let slope = 3.0 * (self.0[j + 1][i] - self.0[j][i]);
                (low, high) = (least(low, slope), most(high, slope));
            }
        }
        (low, high)
    }
}

fn least(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

fn most(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// Least and greatest number.
pub(super) fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (least(low, x), most(high, x)))
}

/// A rectangle of parameters, ends included, within 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rect {
    pub u: (f64, f64),
    pub v: (f64, f64),
}

impl Rect {
    /// The whole patch.
    pub const ALL: Rect = Rect { u: (0.0, 1.0), v: (0.0, 1.0) };

    pub fn centre(&self) -> (f64, f64) {
        (0.5 * (self.u.0 + self.u.1), 0.5 * (self.v.0 + self.v.1))
    }

    /// True if the point is at most `margin` outside.
    pub fn contains(&self, (u, v): (f64, f64), margin: f64) -> bool {
        u >= self.u.0 - margin && u <= self.u.1 + margin && v >= self.v.0 - margin && v <= self.v.1 + margin
    }

    pub fn meets(&self, other: &Self) -> bool {
        self.u.0 <= other.u.1 && self.u.1 >= other.u.0 && self.v.0 <= other.v.1 && self.v.1 >= other.v.0
    }

    pub fn halves_u(&self) -> [Self; 2] {
        let middle = self.centre().0;
        [Self { u: (self.u.0, middle), ..*self }, Self { u: (middle, self.u.1), ..*self }]
    }

    pub fn halves_v(&self) -> [Self; 2] {
        let middle = self.centre().1;
        [Self { v: (self.v.0, middle), ..*self }, Self { v: (middle, self.v.1), ..*self }]
    }

    /// The least rectangle around both.
    pub fn union(&self, other: &Self) -> Self {
        let around = |a: (f64, f64), b: (f64, f64)| (least(a.0, b.0), most(a.1, b.1));
        Self { u: around(self.u, other.u), v: around(self.v, other.v) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn net(seed: i32) -> Net {
        Net(std::array::from_fn(|j| std::array::from_fn(|i| ((7 * i + 13 * j) as i32 * seed % 11) as f64)))
    }

    #[test]
    fn parts_and_halves_have_the_values_of_the_whole() {
        let whole = net(5);
        let rect = Rect { u: (0.25, 0.625), v: (0.5, 0.9) };
        let part = whole.part(&rect);
        let ((left, right), (lower, upper)) = (whole.split_u(), whole.split_v());
        for (u, v) in [(0.0, 0.0), (1.0, 1.0), (0.3, 0.8), (0.5, 0.1)] {
            let at = |net: &Net, u, v| net.value_and_slopes(u, v).0;
            let inner = at(&whole, 0.25 + 0.375 * u, 0.5 + 0.4 * v);
            assert!((at(&part, u, v) - inner).abs() < 1e-13);
            assert!((at(&left, u, v) - at(&whole, 0.5 * u, v)).abs() < 1e-13);
            assert!((at(&right, u, v) - at(&whole, 0.5 + 0.5 * u, v)).abs() < 1e-13);
            assert!((at(&lower, u, v) - at(&whole, u, 0.5 * v)).abs() < 1e-13);
            assert!((at(&upper, u, v) - at(&whole, u, 0.5 + 0.5 * v)).abs() < 1e-13);
        }
        let (low, high) = part.range();
        assert!(low <= at_centre(&part) && at_centre(&part) <= high);
    }

    fn at_centre(net: &Net) -> f64 {
        net.value_and_slopes(0.5, 0.5).0
    }

    #[test]
    fn slopes_are_differences() {
        let net = net(3);
        let (u, v, e) = (0.3, 0.7, 1e-6);
        let at = |u, v| net.value_and_slopes(u, v).0;
        let (along_u, along_v) = net.slopes(u, v);
        assert!((along_u - (at(u + e, v) - at(u - e, v)) / (2.0 * e)).abs() < 1e-6);
        assert!((along_v - (at(u, v + e) - at(u, v - e)) / (2.0 * e)).abs() < 1e-6);
        let (centre_u, centre_v) = net.slopes_at_centre();
        assert!((centre_u - net.slopes(0.5, 0.5).0).abs() < 1e-12);
        assert!((centre_v - net.slopes(0.5, 0.5).1).abs() < 1e-12);
        let ((low_u, high_u), (low_v, high_v)) = (net.slope_range_u(), net.slope_range_v());
        assert!(low_u <= along_u && along_u <= high_u && low_v <= along_v && along_v <= high_v);
    }
}
