//! A torus as a file that is never in memory.

use std::f64::consts::TAU;
use std::fs::File;
use std::io::{BufWriter, Error, ErrorKind, Result, Write};
use std::path::Path;

/// A grid of quads that closes both ways, around the z axis.
struct Torus {
    columns: u32,
    rows: u32,
    /// Cosine and sine of each column's angle around the axis, and of each row's around the tube.
    around: Vec<[f64; 2]>,
    along: Vec<[f64; 2]>,
}

impl Torus {
    fn new(columns: u32, rows: u32) -> Self {
        let turn = |n: u32| {
            (0..n)
                .map(|i| (TAU * f64::from(i) / f64::from(n)).sin_cos())
                .map(|(sin, cos)| [cos, sin])
                .collect()
        };
        Self { columns, rows, around: turn(columns), along: turn(rows) }
    }

    /// Radii 2 and 0.75.
    fn point(&self, vertex: u32) -> [f32; 3] {
        let [cos_u, sin_u] = self.around[(vertex / self.rows) as usize];
        let [cos_v, sin_v] = self.along[(vertex % self.rows) as usize];
        let out = 2.0 + 0.75 * cos_v;
        [out * cos_u, out * sin_u, 0.75 * sin_v].map(|x| x as f32)
    }

    fn vertex_count(&self) -> u32 {
        self.columns * self.rows
    }

    /// Both triangles of each quad, counter-clockwise from outside.
    fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        let (columns, rows) = (self.columns, self.rows);
        let at = move |column: u32, row: u32| column % columns * rows + row % rows;
        let quads = (0..columns).flat_map(move |i| (0..rows).map(move |j| (i, j)));
        quads.flat_map(move |(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
    }
}

/// Writes a closed torus of `faces` triangles, or some more, and gives their number.
pub(crate) fn write(path: &Path, faces: u32) -> Result<u64> {
    let refused = |problem: &str| Err(Error::new(ErrorKind::InvalidInput, problem));
    if faces > 1 << 30 {
        return refused("at most 1,073,741,824 triangles can be made");
    }
    let columns = (faces / 2).isqrt().max(3);
    let torus = Torus::new(columns, (faces / 2).div_ceil(columns).max(3));
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("ply") => ply(&torus, BufWriter::with_capacity(1 << 20, File::create(path)?))?,
        Some("stl") => stl(&torus, BufWriter::with_capacity(1 << 20, File::create(path)?))?,
        _ => return refused("the extension is neither ply nor stl"),
    }
    Ok(2 * u64::from(torus.vertex_count()))
}

fn ply(torus: &Torus, mut file: impl Write) -> Result<()> {
    let vertices = torus.vertex_count();
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        2 * u64::from(vertices)
    )?;
    for vertex in 0..vertices {
        for x in torus.point(vertex) {
            file.write_all(&x.to_le_bytes())?;
        }
    }
    for triangle in torus.triangles() {
        file.write_all(&[3])?;
        for vertex in triangle {
            file.write_all(&vertex.to_le_bytes())?;
        }
    }
    file.flush()
}

fn stl(torus: &Torus, mut file: impl Write) -> Result<()> {
    file.write_all(&[b' '; 80])?;
    file.write_all(&(2 * torus.vertex_count()).to_le_bytes())?;
    for triangle in torus.triangles() {
        // The normal follows from the corners; zeros leave it to the reader.
        file.write_all(&[0; 12])?;
        for x in triangle.map(|vertex| torus.point(vertex)).as_flattened() {
            file.write_all(&x.to_le_bytes())?;
        }
        file.write_all(&[0; 2])?;
    }
    file.flush()
}
