//! What holds for every checkpoint, and for all bytes.

use proptest::collection::vec;
use proptest::prelude::*;

use super::*;

prop_compose! {
    fn any_column(particles: usize)(
        name in "\\PC{1,40}",
        symbol in "\\PC{0,20}",
        unit in "[a-z/0-9]{0,8}",
        about in "\\PC{0,100}",
        state in any::<bool>(),
        integer in any::<bool>(),
        bits in vec(any::<u64>(), particles),
    ) -> Column {
        let data = match integer {
            true => Data::U32(bits.iter().map(|bits| *bits as u32).collect()),
            false => Data::F64(bits.iter().map(|bits| f64::from_bits(*bits)).collect()),
        };
        let role = if state { Role::State } else { Role::Derived };
        Column { name, symbol, unit, about, role, data }
    }
}

prop_compose! {
    fn any_checkpoint()(particles in 0_usize..70)(
        columns in vec(any_column(particles), 0..6),
        step in any::<u64>(),
        time in any::<u64>(),
        step_size in any::<u64>(),
        scalars in vec(("\\PC{0,30}", any::<f64>()), 0..4),
        scene in "\\PC{0,300}",
        revision in "\\PC{0,40}",
    ) -> Checkpoint {
        let (time, step_size) = (f64::from_bits(time), f64::from_bits(step_size));
        Checkpoint { clock: Clock { step, time, step_size, scalars }, scene, revision, columns }
    }
}

/// Equality that knows NaN: both are written into the same bytes.
fn bytes_of(folder: &Path, checkpoint: &Checkpoint) -> Vec<u8> {
    let path = folder.join("again");
    write(&path, checkpoint).unwrap();
    fs::read(path).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn all_that_is_written_comes_back(mut checkpoint in any_checkpoint()) {
        let mut names = std::collections::HashSet::new();
        checkpoint.columns.retain(|column| names.insert(column.name.clone()));
        let folder = tempfile::tempdir().unwrap();
        let bytes = bytes_of(folder.path(), &checkpoint);
        let back = parse(Path::new("bytes"), &bytes).unwrap();
        prop_assert!(bytes_of(folder.path(), &back) == bytes);
        let mapped = Mapped::open(&folder.path().join("again")).unwrap();
        mapped.verify().unwrap();
        for (view, column) in mapped.columns().unwrap().iter().zip(&checkpoint.columns) {
            let mut streamed = Vec::new();
            mapped.stream(view, |values| streamed.extend_from_slice(values)).unwrap();
            let expected: Vec<u64> = match &column.data {
                Data::F64(values) => values.iter().map(|value| value.to_bits()).collect(),
                Data::U32(values) => values.iter().map(|value| f64::from(*value).to_bits()).collect(),
            };
            let streamed: Vec<u64> = streamed.iter().map(|value| value.to_bits()).collect();
            prop_assert_eq!(streamed, expected);
        }
    }

    #[test]
    fn random_bytes_are_no_checkpoint(bytes in vec(any::<u8>(), 0..9000)) {
        prop_assert!(parse(Path::new("bytes"), &bytes).is_err());
    }

    /// Whatever stands in the sections under right checksums, the readers refuse it or understand it.
    #[test]
    fn forged_sections_do_no_harm(
        changes in vec((4096_usize..16_000, any::<u8>()), 1..30),
        words in vec((512_usize..2000, any::<u64>(), 0_u32..64), 0..4),
    ) {
        let (_folder, path, _) = written(100);
        let mut bytes = fs::read(&path).unwrap();
        let mut header = Header::decode(&path, &bytes, bytes.len() as u64).unwrap();
        for (place, byte) in changes {
            let place = 4096 + (place - 4096) % (bytes.len() - 4096);
            bytes[place] = byte;
        }
        for (place, word, shift) in words {
            let place = (8 * place).min(bytes.len() - 8);
            bytes[place..place + 8].copy_from_slice(&(word >> shift).to_le_bytes());
        }
        header.preface.checksum = xxh3_64(&bytes[header.preface_range().unwrap()]);
        header.columns.checksum = xxh3_64(&bytes[header.columns_range().unwrap()]);
        bytes[..HEADER_LENGTH].copy_from_slice(&header.encode());
        let parsed = parse(&path, &bytes);
        fs::write(&path, &bytes).unwrap();
        let mapped = Mapped::open(&path).and_then(|mapped| mapped.verify().map(|()| mapped));
        prop_assert_eq!(parsed.is_ok(), mapped.is_ok());
        if let Ok(mapped) = mapped {
            for column in mapped.columns().unwrap() {
                let mut count = 0;
                mapped.stream(&column, |values| count += values.len()).unwrap();
                prop_assert_eq!(count, column.len());
            }
        }
    }
}
