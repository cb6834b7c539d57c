//! Rows: vectors, random numbers, powers, directions, filters.

use crate::functions::table::{Row, twin};
use lightcuts_kernel::filter::{filter_along, filter_weight, gaussian, mitchell};
use lightcuts_kernel::power::{exp2_polynomial, log2_polynomial, power};
use lightcuts_kernel::rng::{hash4, original_next, original_skip, original_value, random4, stream, unit_float};
use lightcuts_kernel::sampling::{frame, sample_cosine_cone, sin_cos_turns};
use lightcuts_kernel::vector::{
    copy_sign, cross3, dot3, length3, max_element, min_element, quotient, rounded_product, scaled, square_root,
};

/// The rows.
pub(crate) const ROWS: [Row; 29] = [
    twin("dot3", |c| c.put(dot3(c.point(), c.point()))),
    twin("cross3", |c| c.put(cross3(c.point(), c.point()))),
    twin("length3", |c| c.put(length3(c.point()))),
    twin("max_element", |c| c.put(max_element(c.point()))),
    twin("min_element", |c| c.put(min_element(c.point()))),
    twin("rounded_product", |c| c.put(rounded_product(c.float(), c.float()))),
    twin("scaled", |c| c.put(scaled(c.point(), c.float()))),
    twin("quotient", |c| c.put(quotient(c.float(), c.float()))),
    twin("square_root", |c| c.put(square_root(c.positive()))),
    twin("copy_sign", |c| c.put(copy_sign(c.float(), c.float()))),
    twin("hash4", |c| c.put(hash4([c.word(), c.word(), c.word(), c.word()]))),
    twin("unit_float", |c| c.put(unit_float(c.word()))),
    twin("random4", |c| c.put(random4(c.word(), c.word(), c.word(), c.word()))),
    twin("stream", |c| c.put(stream(c.word(), c.word()))),
    twin("original_next", |c| c.put(original_next(c.word()))),
    twin("original_value", |c| c.put(original_value(c.word()))),
    twin("original_skip", |c| c.put(original_skip(c.word(), c.word()))),
    twin("sin_cos_turns", |c| c.put(sin_cos_turns(c.between(-1.0, 2.0)))),
    twin("frame", |c| c.put(frame(c.direction()))),
    twin("sample_cosine_cone", |c| {
        c.put(sample_cosine_cone(c.direction(), c.fraction(), [c.fraction(), c.fraction()]));
    }),
    twin("log2_polynomial", |c| c.put(log2_polynomial(c.any_normal()))),
    twin("exp2_polynomial", |c| c.put(exp2_polynomial(c.between(-150.0, 150.0)))),
    twin("power", |c| c.put(power(c.positive(), c.between(0.0, 200.0)))),
    twin("power", |c| c.put(power(c.fraction(), c.positive()))),
    twin("filter_along", |c| c.put(filter_along(&c.pixel_filter(), c.between(-2.0, 2.0)))),
    twin("filter_weight", |c| c.put(filter_weight(&c.pixel_filter(), c.between(-2.0, 2.0), c.between(-2.0, 2.0)))),
    twin("gaussian", |c| c.put(gaussian(&c.pixel_filter(), c.between(-2.0, 2.0)))),
    twin("mitchell", |c| c.put(mitchell(&c.pixel_filter(), c.between(0.0, 2.0)))),
    twin("mitchell", |c| c.put(mitchell(&c.pixel_filter(), c.positive()))),
];
