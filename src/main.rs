//! The program `skipgrid`.

fn main() {}
