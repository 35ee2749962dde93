//! No pair within its support is ever missing in the list, however the particles move.

use meniscus_engine::clock::Clock;
use meniscus_engine::domain::Domain;
use meniscus_engine::pipeline::{Stage, World};
use meniscus_engine::wiring::Wiring;
use meniscus_stages::equation_of_state::Packing;
use meniscus_stages::sort_bin::{LISTED, SortBin};
use meniscus_tests::liquid::{Random, SIZE};
use std::collections::HashSet;
use std::f64::consts::PI;

/// The skin of a first list.
const SKIN: f64 = 0.1 * SIZE;
const DENSITY: f64 = 1000.0;

struct Cloud {
    packing: Packing,
    world: World,
    sort: SortBin,
}

impl Cloud {
    fn new(domain: Domain, random: &mut Random) -> Self {
        let packing = Packing { domain, theta: 0.6, largest_size: 2.0 * SIZE };
        let mut wiring = Wiring::new();
        let sort = SortBin::new(&mut wiring, packing);
        wiring.read(&meniscus_stages::fields::IDENTITY);
        let (mut r, mut z, mut mass) = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..300 {
            r.push(SIZE * (0.1 + f64::from(i / 20) + 0.09 * random.draw()));
            z.push(SIZE * (0.5 + f64::from(i % 20) + 0.4 * random.draw()));
            let radius = r[r.len() - 1] + domain.origin;
            mass.push(DENSITY * 2.0 * PI * radius * SIZE * SIZE * (1.0 + 0.4 * random.draw()));
        }
        let mut store = wiring.allocate(r.len());
        store.set("radius", &r);
        store.set("axial", &z);
        store.set("mass", &mass);
        store.set("density", &vec![DENSITY; r.len()]);
        store.set("identity", &(0..300).collect::<Vec<u32>>());
        let mut world = World::new(store, Clock::default());
        world.clock.step = 1;
        Cloud { packing, world, sort }
    }

    fn run(&mut self) {
        self.sort.run(&mut self.world).expect("no fault");
    }

    fn column(&self, name: &str) -> Vec<f64> {
        self.world.store.by_name::<f64>(name).expect("a column").to_vec()
    }

    fn identities(&self) -> Vec<u32> {
        self.world.store.by_name::<u32>("identity").expect("a column").to_vec()
    }

    /// Half the support radius of every particle at the present positions and densities.
    fn reach(&self) -> Vec<f64> {
        let [r, mass, density] = ["radius", "mass", "density"].map(|name| self.column(name));
        let reach = |i: usize| {
            let area = mass[i] / (2.0 * PI * (r[i] + self.packing.domain.origin) * density[i]);
            2.0 * self.packing.theta * area.sqrt().min(self.packing.largest_size)
        };
        (0..r.len()).map(reach).collect()
    }

    /// Moves every particle by a share of what its own half of the skin leaves, in a direction that
    /// the test chooses; the growth of the support counts as well.
    fn shake(&mut self, share: f64, direction: &mut dyn FnMut([f64; 2]) -> f64) {
        let [mut r, mut z, list_r, list_z, list_reach] =
            ["radius", "axial", "list_radius", "list_axial", "list_reach"].map(|name| self.column(name));
        for i in 0..r.len() {
            let angle = direction([r[i], z[i]]);
            // Towards the axis a support grows: .4 of the skin leaves room for that.
            let target = 0.4 * SKIN * share;
            let to = [list_r[i] + target * angle.cos(), list_z[i] + target * angle.sin()];
            let before = (r[i], z[i]);
            r[i] = to[0].max(0.02 * SIZE);
            z[i] = to[1];
            self.world.store.set("radius", &r);
            let used = (r[i] - list_r[i]).hypot(z[i] - list_z[i]) + self.reach()[i];
            if used >= list_reach[i] {
                (r[i], z[i]) = before;
            }
        }
        self.world.store.set("radius", &r);
        self.world.store.set("axial", &z);
    }

    /// Every pair within its support, images included, that the list lacks.
    fn missing(&self) -> usize {
        let (r, z, reach) = (self.column("radius"), self.column("axial"), self.reach());
        let Domain { origin, period } = self.packing.domain;
        let list = &self.world.neighbours;
        let shifts = period.map_or(vec![0.0], |(_, length)| vec![-length, 0.0, length]);
        let mut missing = 0;
        for a in 0..r.len() {
            let listed: HashSet<(usize, bool, u64)> = list
                .of(a)
                .map(|number| match number.checked_sub(list.len()) {
                    None => (number, false, 0.0f64.to_bits()),
                    Some(image) => {
                        let image = &list.images()[image];
                        (image.source as usize, image.mirrored, image.shift.to_bits())
                    }
                })
                .collect();
            for b in 0..r.len() {
                for shift in &shifts {
                    for mirrored in [false, true] {
                        let at = if mirrored { -r[b] - 2.0 * origin } else { r[b] };
                        let near = (at - r[a]).hypot(z[b] + shift - z[a]) < reach[a] + reach[b];
                        let itself = a == b && !mirrored && *shift == 0.0;
                        if near && !itself && !listed.contains(&(b, mirrored, shift.to_bits())) {
                            missing += 1;
                        }
                    }
                }
            }
        }
        missing
    }
}

fn domains() -> [Domain; 3] {
    let period = Some((0.0, 20.0 * SIZE));
    [Domain { origin: 0.0, period: None }, Domain { origin: 0.0, period }, Domain { origin: 1.0, period }]
}

#[test]
fn random_walks_within_the_skin() {
    for domain in domains() {
        let mut random = Random::new(37);
        let mut cloud = Cloud::new(domain, &mut random);
        cloud.world.clock.step = 0;
        cloud.run();
        for _ in 0..10 {
            cloud.shake(0.999, &mut |_| PI * random.draw());
            let builds = cloud.world.neighbours.builds();
            cloud.run();
            assert_eq!(cloud.world.neighbours.builds(), builds, "below the criterion");
            assert_eq!(cloud.missing(), 0, "{domain:?}");
        }
    }
}

#[test]
fn everything_rushes_to_one_point_over_many_rebuilds() {
    for domain in domains() {
        let mut random = Random::new(41);
        let mut cloud = Cloud::new(domain, &mut random);
        cloud.world.clock.step = 0;
        cloud.run();
        for round in 0..12 {
            let centre = [4.0 * SIZE, (4.0 + f64::from(round)) * SIZE];
            cloud.shake(0.999, &mut |[r, z]| (centre[1] - z).atan2(centre[0] - r));
            cloud.run();
            assert_eq!(cloud.missing(), 0, "{domain:?}, round {round}");
            // One particle far beyond its half of the skin: the list must follow.
            let mut z = cloud.column("axial");
            z[round as usize * 7] += 3.0 * SKIN;
            cloud.world.store.set("axial", &z);
            let builds = cloud.world.neighbours.builds();
            cloud.run();
            assert_eq!(cloud.world.neighbours.builds(), builds + 1);
            assert_eq!(cloud.missing(), 0, "{domain:?}, round {round}");
        }
    }
}

#[test]
fn growing_supports_use_up_the_skin() {
    let mut cloud = Cloud::new(domains()[0], &mut Random::new(43));
    cloud.world.clock.step = 0;
    cloud.run();
    for round in 0..20 {
        // All particles expand in place, as in a rarefaction.
        let density: Vec<f64> = cloud.column("density").iter().map(|rho| 0.97 * rho).collect();
        cloud.world.store.set("density", &density);
        cloud.run();
        assert_eq!(cloud.missing(), 0, "round {round}");
    }
    assert!(cloud.world.neighbours.builds() > 2);
}

#[test]
fn the_skin_follows_the_speed() {
    // The skins of the list after a build, for particles that moved by so much a step since the build before, the first
    // one so many times as far.
    let skins_after = |a_step: f64, times: f64| {
        let mut cloud = Cloud::new(domains()[0], &mut Random::new(47));
        cloud.world.clock.step = 0;
        cloud.run();
        let moved = 0.1 * SIZE;
        let mut z: Vec<f64> = cloud.column("axial").iter().map(|z| z + moved).collect();
        let first = cloud.identities().iter().position(|&identity| identity == 0).expect("the first one");
        z[first] += (times - 1.0) * moved;
        cloud.world.store.set("axial", &z);
        cloud.world.clock = Clock::at(10, moved / a_step * 1e-9, 1e-9);
        cloud.world.clock.set_number(LISTED, 0.0);
        cloud.run();
        assert_eq!(cloud.missing(), 0);
        let (listed, reach, identities) = (cloud.column("list_reach"), cloud.reach(), cloud.identities());
        [0, 1].map(|wanted| {
            let i = identities.iter().position(|&identity| identity == wanted).expect("both");
            2.0 * (listed[i] - reach[i])
        })
    };
    let skin_after = |a_step: f64| skins_after(a_step, 1.0)[1];
    let (slow, fast) = (skin_after(1e-3 * SIZE), skin_after(4e-3 * SIZE));
    assert!((fast / slow - 2.0).abs() < 1e-6, "the square root of the speed: {slow} {fast}");
    assert!(skin_after(10.0 * SIZE) <= 1.0001 * SIZE && skin_after(1e-9 * SIZE) >= 0.0199 * SIZE);
    // One that is five times as fast as the others has a skin of its own.
    let [own, others] = skins_after(1e-3 * SIZE, 5.0);
    let mean = (5.0 + 299.0) / 300.0;
    let expected = (1.25 * 5.0 + 0.25 * mean) / (1.25 + 0.25 * mean);
    assert!((own / others - expected).abs() < 1e-6, "{own} against {others}");
    assert!((others / slow - 1.0).abs() < 0.01, "they hardly feel it: {others} against {slow}");
}

/// Who was moved from outside may lie anywhere in its circle: the way that particles may go unseen is counted from where they
/// were.
#[test]
fn a_move_from_outside_leaves_no_margin() {
    let mut cloud = Cloud::new(domains()[0], &mut Random::new(53));
    cloud.run();
    let (margin, builds) = (cloud.world.neighbours.margin, cloud.world.neighbours.builds());
    let moved: Vec<f64> = cloud.column("axial").iter().map(|z| z + 0.6 * margin).collect();
    cloud.world.store.set("axial", &moved);
    cloud.run();
    assert!(margin > 0.0 && cloud.world.neighbours.builds() == builds, "the list still holds");
    assert_eq!(cloud.world.neighbours.margin, 0.0);
}
