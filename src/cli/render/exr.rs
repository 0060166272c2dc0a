//! Frames as OpenEXR files.
//!
//! One part of 32-bit floats, compressed by ZIP in blocks of 16 rows. Of a cropped picture the data window is the crop,
//! and the display window the whole picture. Colour is in the channels `R`, `G`, `B` and, with
//! the alpha layer, `A`: linear and premultiplied, with the chromaticities of Rec. 709. The direction of the sky is in
//! `sky.x`, `sky.y` and `sky.z`, its place in a panorama in `sky.u` and `sky.v`. Each other layer is a channel
//! `disk.NAME`. Text attributes hold the program's version (`software`) and the [`FrameOrigin`]: `darkness:scene`,
//! `darkness:table`, `darkness:frame`. The format does not check its data, so `darkness:crc32` holds the CRC-32 of the
//! whole file with eight zeros in its own place.

use std::io::{self, Cursor, Write};
use std::iter::once;

use exr::block;
use exr::block::chunk::{Chunk, CompressedBlock, CompressedScanLineBlock};
use exr::block::writer::ChunksWriter;
use exr::math::Vec2;
use exr::meta::BlockDescription;
use exr::meta::attribute::{
    AttributeValue, ChannelDescription, Chromaticities, Compression, IntegerBounds, LineOrder,
    SampleType, Text,
};
use exr::meta::header::Header;
use flate2::write::ZlibEncoder;

use super::memory;
use super::origin::{ANY_VERSION, FrameOrigin, HEAD, SOFTWARE};
use crate::render::Plane;
use crate::scene::{ImageSize, Layer, Region};

/// The attribute with the file's checksum.
const CHECKSUM: &str = "darkness:crc32";

/// What stands in place of the checksum while it is computed.
const NO_CHECKSUM: &str = "00000000";

/// The first bytes of every OpenEXR file.
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// The bytes of magic number and version, before the first attribute.
const START: usize = 8;

/// The rows of a compressed block.
const ROWS: usize = 16;

/// A channel of a file, and where its values are.
struct Channel<'a> {
    name: String,
    plane: &'a Plane,
    /// Which of the layer's numbers.
    offset: usize,
}

/// Encodes a frame.
///
/// # Errors
/// There is not enough memory to encode the frame.
pub(super) fn encode(
    planes: &[Plane],
    (whole, part): (ImageSize, Region),
    origin: &FrameOrigin,
) -> io::Result<Vec<u8>> {
    let (width, height) = (part.width as usize, part.height as usize);
    let mut channels: Vec<Channel<'_>> = planes.iter().flat_map(channels_of).collect();
    // The format demands this order.
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    memory::grant(width * height * channels.len() * size_of::<f32>())?;

    let header = header(&channels, (whole, part), origin);
    let mut file = Cursor::new(Vec::new());
    block::write(&mut file, once(header).collect(), true, |_, writer| {
        for (place, top) in (0..height).step_by(ROWS).enumerate() {
            let mut values = Vec::new();
            for row in top..height.min(top + ROWS) {
                for Channel { plane, offset, .. } in &channels {
                    let (first, count) = (row * width, plane.layer.channels());
                    let row = &plane.values[first * count..(first + width) * count];
                    let row = row[*offset..].iter().step_by(count);
                    values.extend(row.flat_map(|value| value.to_le_bytes()));
                }
            }
            let block = CompressedScanLineBlock {
                y_coordinate: part.top as i32 + top as i32,
                compressed_pixels_le: zipped(values)?,
            };
            let chunk = Chunk {
                layer_index: 0,
                compressed_block: CompressedBlock::ScanLine(block),
            };
            writer.write_chunk(place, chunk)?;
        }
        Ok(())
    })
    .map_err(io::Error::other)?;
    Ok(signed(sorted(file.into_inner())))
}

/// A block's values, compressed as the format's ZIP is: all first bytes of two and all second ones, as differences,
/// deflated; as they are where that is longer. The crate's own compression takes three times as long, for a tenth less.
fn zipped(values: Vec<u8>) -> io::Result<Vec<u8>> {
    let (pairs, _) = values.as_chunks::<2>();
    let bytes = (pairs.iter().map(|pair| pair[0])).chain(pairs.iter().map(|pair| pair[1]));
    // The first byte stands for itself.
    let mut last = 128;
    let differences: Vec<u8> = bytes
        .map(|byte| {
            byte.wrapping_sub(std::mem::replace(&mut last, byte))
                .wrapping_add(128)
        })
        .collect();
    let mut encoder = ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(&differences)?;
    let zipped = encoder.finish()?;
    Ok(if zipped.len() < values.len() {
        zipped
    } else {
        values
    })
}

/// Whether a file that begins with `head` is an OpenEXR file that some version of this program made.
pub(super) fn is_ours(head: &[u8]) -> bool {
    let text = find(head, b"software\0string\0").map(|place| &head[place + 16..]);
    let is_ours = |text: &[u8]| {
        text.get(4..)
            .is_some_and(|text| text.starts_with(ANY_VERSION.as_bytes()))
    };
    head.starts_with(&MAGIC) && text.is_some_and(is_ours)
}

/// Whether `file` is a whole file, with the right checksum, that this version of the program made of `origin`.
pub(super) fn made(file: &[u8], origin: &FrameOrigin) -> bool {
    let head = &file[..file.len().min(HEAD)];
    let has = |key, text: &str| find(head, &attribute(key, text)).is_some();
    let is_whole = checksum(file).is_some_and(|checksum| has(CHECKSUM, &checksum));
    let key = |key| if key == SOFTWARE { "software" } else { key };
    let texts = origin.texts();
    is_whole && texts.iter().all(|(name, text)| has(key(name), text))
}

/// The channels of a layer.
fn channels_of(plane: &Plane) -> Vec<Channel<'_>> {
    let names = match plane.layer {
        Layer::Colour => vec!["R".into(), "G".into(), "B".into()],
        Layer::Alpha => vec!["A".into()],
        Layer::Sky => vec!["sky.x".into(), "sky.y".into(), "sky.z".into()],
        Layer::SkyUv => vec!["sky.u".into(), "sky.v".into()],
        layer => vec![format!("disk.{}", layer.name())],
    };
    let channel = |(offset, name)| Channel {
        name,
        plane,
        offset,
    };
    names.into_iter().enumerate().map(channel).collect()
}

/// The header of a file with these channels, of a part of a picture.
fn header(
    channels: &[Channel<'_>],
    (whole, part): (ImageSize, Region),
    origin: &FrameOrigin,
) -> Header {
    let described = channels
        .iter()
        .map(|channel| ChannelDescription::named(channel.name.as_str(), SampleType::F32));
    let size = (part.width as usize, part.height as usize);
    let header = Header::new(Text::default(), size, described.collect());
    let mut header = header.with_encoding(
        Compression::ZIP16,
        BlockDescription::ScanLines,
        LineOrder::Increasing,
    );
    header.own_attributes.layer_name = None;
    // The data window is the part, the display window the whole picture.
    header.own_attributes.layer_position = Vec2(part.left as i32, part.top as i32);
    header.shared_attributes.display_window = IntegerBounds {
        position: Vec2(0, 0),
        size: Vec2(whole.width as usize, whole.height as usize),
    };
    header.shared_attributes.chromaticities = Some(Chromaticities {
        red: Vec2(0.64, 0.33),
        green: Vec2(0.30, 0.60),
        blue: Vec2(0.15, 0.06),
        white: Vec2(0.3127, 0.3290),
    });
    for (key, text) in origin
        .texts()
        .into_iter()
        .chain([(CHECKSUM, NO_CHECKSUM.into())])
    {
        if key == SOFTWARE {
            header.own_attributes.software_name = Some(text.as_str().into());
        } else {
            let text = AttributeValue::Text(text.as_str().into());
            header.own_attributes.other.insert(key.into(), text);
        }
    }
    header
}

/// A text attribute, as it stands in a file.
fn attribute(name: &str, text: &str) -> Vec<u8> {
    let length = (text.len() as u32).to_le_bytes();
    [name.as_bytes(), b"\0string\0", &length, text.as_bytes()].concat()
}

/// Sorts the attributes of a file by their names: the encoder writes them in an order that changes from run to run.
fn sorted(mut file: Vec<u8>) -> Vec<u8> {
    let mut attributes = Vec::new();
    let mut rest = &file[START..];
    while let Some((attribute, after)) = split_attribute(rest) {
        attributes.push(attribute);
        rest = after;
    }
    attributes.sort_unstable();
    let sorted = attributes.concat();
    file[START..START + sorted.len()].copy_from_slice(&sorted);
    file
}

/// The first attribute (its name, its type, the length of its value, its value), and what follows.
fn split_attribute(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let end = |bytes: &[u8]| bytes.iter().position(|&byte| byte == 0);
    let name = end(bytes).filter(|&length| length > 0)? + 1;
    let kind = end(&bytes[name..])? + 1;
    let length = bytes[name + kind..].first_chunk()?;
    let length = u32::from_le_bytes(*length) as usize;
    bytes.split_at_checked(name + kind + 4 + length)
}

/// Puts the checksum into a file.
fn signed(mut file: Vec<u8>) -> Vec<u8> {
    if let Some(place) = checksum_place(&file)
        && let Some(checksum) = checksum(&file)
    {
        file[place..place + NO_CHECKSUM.len()].copy_from_slice(checksum.as_bytes());
    }
    file
}

/// The CRC-32 of a file with zeros in place of the checksum, in hexadecimal.
fn checksum(file: &[u8]) -> Option<String> {
    let (before, rest) = file.split_at(checksum_place(file)?);
    let after = rest.get(NO_CHECKSUM.len()..)?;
    let mut hasher = crc32fast::Hasher::new();
    for part in [before, NO_CHECKSUM.as_bytes(), after] {
        hasher.update(part);
    }
    Some(format!("{:08x}", hasher.finalize()))
}

/// Where the checksum begins.
fn checksum_place(file: &[u8]) -> Option<usize> {
    let attribute = attribute(CHECKSUM, NO_CHECKSUM);
    let before = &attribute[..attribute.len() - NO_CHECKSUM.len()];
    Some(find(&file[..file.len().min(HEAD)], before)? + before.len())
}

/// Where `needle` begins in `bytes`.
fn find(bytes: &[u8], needle: &[u8]) -> Option<usize> {
    bytes
        .windows(needle.len())
        .position(|window| window == needle)
}

#[cfg(test)]
mod tests {
    use exr::prelude::{ReadChannels, ReadLayers, read};

    use super::super::origin::PROGRAM;
    use super::super::origin::tests::{
        assert_no_other_is_taken, assert_only_ours_is_taken, origin,
    };
    use super::*;

    const SIZE: ImageSize = ImageSize {
        width: 5,
        height: 37,
    };

    fn whole() -> (ImageSize, Region) {
        (SIZE, Region::whole(SIZE))
    }

    /// Layers with numbers that tell where they belong.
    fn planes() -> Vec<Plane> {
        let layers = [
            Layer::Order,
            Layer::Redshift,
            Layer::Colour,
            Layer::Sky,
            Layer::SkyUv,
            Layer::Alpha,
        ];
        let plane = |layer: Layer| {
            let values = (0..5 * 37 * layer.channels()).map(|i| (i as f32).sqrt() - 1.0);
            Plane {
                layer,
                values: values.collect(),
            }
        };
        let mut planes: Vec<Plane> = layers.map(plane).into();
        planes[1].values[7] = f32::NAN;
        planes
    }

    #[test]
    fn channels_and_attributes_come_back() {
        let planes = planes();
        let file = encode(&planes, whole(), &origin(12)).unwrap();
        assert_eq!(file, encode(&planes, whole(), &origin(12)).unwrap());
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_buffered(Cursor::new(&file))
            .unwrap();
        let layer = &image.layer_data;
        assert_eq!(layer.attributes.layer_name, None);
        assert_eq!(layer.attributes.software_name, Some(PROGRAM.into()));
        let text = |name: &str| layer.attributes.other[&Text::from(name)].clone();
        assert_eq!(text("darkness:frame"), AttributeValue::Text("12".into()));
        assert_eq!(
            image.attributes.chromaticities.unwrap().red,
            Vec2(0.64, 0.33)
        );
        let channels = &layer.channel_data.list;
        let names: Vec<_> = channels
            .iter()
            .map(|channel| channel.name.to_string())
            .collect();
        assert_eq!(
            names,
            [
                "A",
                "B",
                "G",
                "R",
                "disk.order",
                "disk.redshift",
                "sky.u",
                "sky.v",
                "sky.x",
                "sky.y",
                "sky.z"
            ]
        );
        let bits = |channel: usize| -> Vec<u32> {
            let values = channels[channel].sample_data.values_as_f32();
            values.map(f32::to_bits).collect()
        };
        let expected = |plane: &Plane, offset: usize| -> Vec<u32> {
            let values = plane.values[offset..].iter();
            values
                .step_by(plane.layer.channels())
                .map(|value| value.to_bits())
                .collect()
        };
        let places = [(5, 0), (2, 2), (2, 1), (2, 0), (0, 0), (1, 0)];
        let sky = [(4, 0), (4, 1), (3, 0), (3, 1), (3, 2)];
        for (channel, (plane, offset)) in places.into_iter().chain(sky).enumerate() {
            assert_eq!(bits(channel), expected(&planes[plane], offset), "{channel}");
        }
    }

    #[test]
    fn a_file_of_another_origin_or_with_any_damage_is_not_taken_for_the_same() {
        let file = encode(&planes(), whole(), &origin(12)).unwrap();
        assert_no_other_is_taken(&file, &origin(12), made);
        assert_only_ours_is_taken(&file, is_ours);
    }
}
