//! Checks the chunks of a `.vox` file, so that nothing is passed over in silence afterwards.
//!
//! A chunk is four letters, the bytes of its content, the bytes of its children, then both. Only the outermost one, `MAIN`,
//! has children.

/// Most bytes of a file.
const MAX_BYTES: usize = 1 << 30;
/// Most models, nodes and layers of each kind.
const MAX_ITEMS: u32 = 1 << 20;
/// Largest edge of a model: a voxel's place along an axis is one byte.
const MAX_SIZE: u32 = 256;

type Checked<T> = std::result::Result<T, String>;

/// The error is place and cause.
pub(super) fn check(bytes: &[u8]) -> Checked<()> {
    if bytes.len() > MAX_BYTES {
        return Err(format!("{} bytes, at most {MAX_BYTES} are read", bytes.len()));
    }
    if !bytes.starts_with(b"VOX ") {
        let start = &bytes[..bytes.len().min(4)];
        return Err(format!("starts with `{}`, not `VOX `", start.escape_ascii()));
    }
    let mut input = Input { bytes, at: 4 };
    let version = input.word("version")?;
    if version != 150 && version != 200 {
        return Err(format!("version {version}, only 150 and 200 are read"));
    }
    let main = input.chunk()?;
    if main.name != b"MAIN" {
        return Err(format!("byte {}: the first chunk is `{}`, not `MAIN`", main.begin, main.name.escape_ascii()));
    }
    let mut inner = Input { bytes: &bytes[..main.end], at: main.children };
    let mut state = State::default();
    while inner.at < main.end {
        let chunk = inner.chunk()?;
        if chunk.children != chunk.end {
            let name = chunk.name.escape_ascii();
            return Err(format!("byte {}: chunk `{name}` has children, which only `MAIN` may have", chunk.begin));
        }
        let mut content = Input { bytes: &bytes[..chunk.end], at: chunk.content };
        state
            .chunk(chunk.name, &mut content)
            .map_err(|cause| format!("byte {}: chunk `{}`: {cause}", chunk.begin, chunk.name.escape_ascii()))?;
    }
    if main.end != bytes.len() {
        let after = bytes.len() - main.end;
        return Err(format!("byte {}: {after} bytes follow the chunk `MAIN`", main.end));
    }
    match state.size {
        Some(_) => Err("the last chunk `SIZE` has no chunk `XYZI` after it".into()),
        None => Ok(()),
    }
}

/// What has been seen.
#[derive(Default)]
struct State {
    /// Of the model to come.
    size: Option<[u32; 3]>,
    models: u32,
    nodes: u32,
    layers: u32,
}

impl State {
    fn chunk(&mut self, name: &[u8], input: &mut Input) -> Checked<()> {
        match name {
            b"SIZE" => {
                if self.size.is_some() {
                    return Err("a second size for one model".into());
                }
                let size = [input.word("size")?, input.word("size")?, input.word("size")?];
                if !size.iter().all(|n| (1..=MAX_SIZE).contains(n)) {
                    let [x, y, z] = size;
                    return Err(format!(
                        "model {} of {x} x {y} x {z} voxels; 1 to {MAX_SIZE} are possible",
                        self.models
                    ));
                }
                self.size = Some(size);
                input.end()
            }
            b"XYZI" => self.voxels(input),
            b"RGBA" if input.left() != 1024 => Err(format!("{} bytes, a palette has 1024", input.left())),
            b"MATL" => {
                input.word("identifier")?;
                input.dictionary()
            }
            b"LAYR" => {
                one_more(&mut self.layers, input.word("identifier")?, "layer")?;
                input.dictionary()
            }
            b"nTRN" => {
                self.node(input)?;
                for what in ["child", "reserved number", "layer"] {
                    input.word(what)?;
                }
                let frames = input.count("frames", 4)?;
                if frames == 0 {
                    return Err("no frame".into());
                }
                (0..frames).try_for_each(|_| input.dictionary())
            }
            b"nGRP" => {
                self.node(input)?;
                let children = input.count("children", 4)?;
                (0..children).try_for_each(|_| input.word("child").map(drop))
            }
            b"nSHP" => {
                self.node(input)?;
                let models = input.count("models", 8)?;
                (0..models).try_for_each(|_| input.word("model").and_then(|_| input.dictionary()))
            }
            // Colours in another order on the palette's screen; cameras, notes, settings of the renderer.
            _ => Ok(()),
        }
    }

    fn voxels(&mut self, input: &mut Input) -> Checked<()> {
        let size = self.size.take().ok_or("no chunk `SIZE` before it")?;
        let count = input.count("voxels", 4)?;
        if input.left() != 4 * count as usize {
            return Err(format!("{count} voxels take {} bytes, {} are there", 4 * u64::from(count), input.left()));
        }
        for i in 0..count {
            let [x, y, z, colour] = input.word("voxel")?.to_le_bytes();
            if [x, y, z].iter().zip(size).any(|(&p, n)| u32::from(p) >= n) {
                let [nx, ny, nz] = size;
                let model = self.models;
                return Err(format!("voxel {i} at {x}, {y}, {z} of model {model}, which is {nx} x {ny} x {nz}"));
            }
            if colour == 0 {
                return Err(format!("voxel {i} of model {} has colour 0, which is none", self.models));
            }
        }
        let number = self.models;
        one_more(&mut self.models, number, "model")
    }

    fn node(&mut self, input: &mut Input) -> Checked<()> {
        one_more(&mut self.nodes, input.word("identifier")?, "node")?;
        input.dictionary()
    }
}

/// Counts an item whose identifier must be its number.
fn one_more(count: &mut u32, identifier: u32, what: &str) -> Checked<()> {
    if identifier != *count {
        return Err(format!("{what} {identifier} stands where {what} {count} is expected"));
    }
    if *count == MAX_ITEMS {
        return Err(format!("more than {MAX_ITEMS} {what}s"));
    }
    *count += 1;
    Ok(())
}

/// Places in the file.
struct Chunk<'a> {
    name: &'a [u8],
    begin: usize,
    content: usize,
    children: usize,
    end: usize,
}

/// Bytes up to an end, and where to read on.
struct Input<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Input<'a> {
    fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn take(&mut self, count: usize, what: &str) -> Checked<&'a [u8]> {
        let taken = self
            .bytes
            .get(self.at..)
            .and_then(|rest| rest.get(..count))
            .ok_or_else(|| format!("byte {}: {what} of {count} bytes, {} are left", self.at, self.left()))?;
        self.at += count;
        Ok(taken)
    }

    fn word(&mut self, what: &str) -> Checked<u32> {
        let bytes = self.take(4, what)?;
        Ok(bytes.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte)))
    }

    /// A number of items of `least` bytes at least, which must be there.
    fn count(&mut self, what: &str, least: usize) -> Checked<u32> {
        let count = self.word(what)?;
        if count as usize > self.left() / least {
            return Err(format!("{count} {what} do not fit in {} bytes", self.left()));
        }
        Ok(count)
    }

    fn dictionary(&mut self) -> Checked<()> {
        let entries = self.count("entries of a dictionary", 8)?;
        for _ in 0..2 * entries {
            let length = self.word("text's length")?;
            let text = self.take(length as usize, "text")?;
            if std::str::from_utf8(text).is_err() {
                return Err(format!("byte {}: a text is not UTF-8", self.at - text.len()));
            }
        }
        Ok(())
    }

    fn end(&self) -> Checked<()> {
        if self.left() > 0 { Err(format!("{} bytes too many", self.left())) } else { Ok(()) }
    }

    fn chunk(&mut self) -> Checked<Chunk<'a>> {
        let begin = self.at;
        let name = self.take(4, "chunk's name")?;
        if !name.is_ascii() {
            return Err(format!("byte {begin}: `{}` is no chunk's name", name.escape_ascii()));
        }
        let (content, children) = (self.word("chunk's size")?, self.word("children's size")?);
        let place = self.at;
        let wanted = u64::from(content) + u64::from(children);
        if wanted > self.left() as u64 {
            let name = name.escape_ascii();
            return Err(format!("byte {begin}: chunk `{name}` of {wanted} bytes, {} are left", self.left()));
        }
        self.at += wanted as usize;
        Ok(Chunk { name, begin, content: place, children: place + content as usize, end: self.at })
    }
}
