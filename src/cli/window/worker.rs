//! The thread that works: reads files and draws what is asked for. The newest request wins.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use umbrage::geom::Aabb;
use umbrage::gpu::Gpu;
use umbrage::render::Ground;
use umbrage::scene::Lamp;
use umbrage::view::{Camera, Size, Up};

use super::defects::Defects;
use super::frame::{Answer, Stage};
use super::state::Request;
use crate::cli::input::{Source, SourceArgs};
use crate::cli::view::ViewArgs;
use crate::cli::{Failure, output};

/// What the worker has to say.
pub(super) enum News {
    Opened(Box<Facts>),
    Drawn(Box<Answer>),
    Defects(Arc<OnceLock<Defects>>),
    /// What could not be done; the number of the request, if it was one.
    Failed(Option<u64>, String),
}

/// What the window has to know of a scene.
#[derive(Clone, Debug)]
pub(super) struct Facts {
    pub(super) file: PathBuf,
    pub(super) faces: usize,
    pub(super) bounds: Aabb,
    pub(super) up: Up,
    pub(super) camera: Camera,
    pub(super) lamps: Vec<Lamp>,
}

/// How files are read.
#[derive(Clone)]
pub(super) struct Opener {
    pub(super) source: SourceArgs,
    pub(super) view: ViewArgs,
    pub(super) size: Size,
    pub(super) ground: bool,
}

/// A scene that was read.
pub(super) struct Opened {
    source: Source,
    ground: Option<Ground>,
    facts: Facts,
}

impl Opener {
    /// Reads a file. Notes go to standard error.
    pub(super) fn open(&self, file: PathBuf) -> Result<Opened, Failure> {
        let args = SourceArgs { file, ..self.source.clone() };
        let mut source = args.load()?;
        let (bounds, up) = (source.bounds, source.up);
        let camera = self.view.choose(&source.cameras, &args.file, &bounds, up, self.size)?;
        let ground = match self.ground {
            true => Some(
                source
                    .add_ground()
                    .map_err(|error| Failure::new(error, "leave out --ground").in_file(&args.file))?,
            ),
            false => None,
        };
        let faces = source.seen().mesh().face_count();
        let lamps = source.lights.clone();
        let facts = Facts { file: args.file, faces, bounds, up, camera, lamps };
        Ok(Opened { source, ground, facts })
    }
}

impl Opened {
    pub(super) fn facts(&self) -> &Facts {
        &self.facts
    }

    /// The number of faces that cast, but for those of a ground that was added.
    fn own_faces(&self) -> usize {
        let seen = self.source.seen().mesh().face_count();
        let of_ground = self.ground.map_or(0, |ground| seen - ground.first_face.index());
        self.source.caster.mesh().face_count() - of_ground
    }
}

/// What the worker is to do next.
#[derive(Default)]
struct Slot {
    open: Option<PathBuf>,
    draw: Option<Request>,
    stop: bool,
}

#[derive(Default)]
struct Shared {
    slot: Mutex<Slot>,
    called: Condvar,
    /// The number of the newest request.
    newest: AtomicU64,
}

impl Shared {
    fn slot(&self) -> MutexGuard<'_, Slot> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// How long the end of the thread is waited for.
const PATIENCE: Duration = Duration::from_secs(5);

/// The thread that works. It ends when this is dropped.
pub(super) struct Worker {
    shared: Arc<Shared>,
    news: Receiver<News>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Begins with a scene that was read. `wake` is called after each of the news.
    pub(super) fn start(
        opener: Opener,
        opened: Opened,
        gpu: Option<Gpu>,
        wake: impl Fn() + Send + 'static,
    ) -> Self {
        let shared = Arc::new(Shared::default());
        let (sender, news) = channel();
        let tell = Teller { sender, wake: Box::new(wake) };
        let work = shared.clone();
        let thread = thread::spawn(move || run(&work, &opener, opened, gpu.as_ref(), &tell));
        Self { shared, news, thread: Some(thread) }
    }

    /// Asks for a picture, in place of any that is asked for already.
    pub(super) fn draw(&self, request: Request) {
        self.shared.newest.store(request.number, Ordering::Release);
        self.shared.slot().draw = Some(request);
        self.shared.called.notify_one();
    }

    /// Asks for another file.
    pub(super) fn open(&self, file: PathBuf) {
        // Whatever is being drawn is of the file before.
        self.shared.newest.store(u64::MAX, Ordering::Release);
        self.shared.slot().open = Some(file);
        self.shared.called.notify_one();
    }

    /// What has been said since the last call.
    pub(super) fn news(&self) -> Vec<News> {
        self.news.try_iter().collect()
    }

    /// Whether the thread has ended, which it does by itself after a defect of its own only.
    pub(super) fn has_ended(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Asks the thread to end.
    pub(super) fn stop(&self) {
        self.shared.newest.store(u64::MAX, Ordering::Release);
        self.shared.slot().stop = true;
        self.shared.called.notify_one();
    }
}

impl Drop for Worker {
    /// Waits for the thread, which lets go of the adapter: drivers do not bear that while the process ends. A
    /// thread that computes for longer is left alone; the adapter is not in use then.
    fn drop(&mut self) {
        self.stop();
        let start = Instant::now();
        while !self.has_ended() && start.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(2));
        }
        if self.has_ended()
            && let Some(thread) = self.thread.take()
        {
            // A panic was reported when it happened.
            let _ = thread.join();
        }
    }
}

struct Teller {
    sender: Sender<News>,
    wake: Box<dyn Fn() + Send>,
}

impl Teller {
    fn tell(&self, news: News) {
        // Nobody listens once the window is closed.
        let _ = self.sender.send(news);
        (self.wake)();
    }
}

fn run(shared: &Shared, opener: &Opener, mut opened: Opened, gpu: Option<&Gpu>, tell: &Teller) {
    loop {
        let Some(file) = serve(shared, opener, &opened, gpu, tell) else { return };
        match opener.open(file) {
            Ok(other) => {
                tell.tell(News::Opened(Box::new(other.facts.clone())));
                opened = other;
            }
            // The scene before stays.
            Err(failure) => {
                output::say(&failure);
                tell.tell(News::Failed(None, failure.to_string()));
            }
        }
    }
}

/// Draws a scene until another file is asked for; `None` if the work is over.
fn serve(
    shared: &Shared,
    opener: &Opener,
    opened: &Opened,
    gpu: Option<&Gpu>,
    tell: &Teller,
) -> Option<PathBuf> {
    let is_balanced = !opener.source.lights.were_asked_for();
    let casters = opened.source.group();
    let mut stage = Stage::new(&opened.source, &casters, opened.ground, is_balanced, gpu);
    let defects = Arc::new(OnceLock::new());
    loop {
        let mut slot = shared.slot();
        let request = loop {
            if slot.stop {
                return None;
            }
            if let Some(file) = slot.open.take() {
                // What was asked for before is about the scene before.
                slot.draw = None;
                return Some(file);
            }
            if let Some(request) = slot.draw.take() {
                break request;
            }
            slot = shared.called.wait(slot).unwrap_or_else(PoisonError::into_inner);
        };
        drop(slot);
        let is_stale = || shared.newest.load(Ordering::Acquire) != request.number;
        match stage.draw(&request, &defects, &is_stale) {
            Ok(Some(answer)) => tell.tell(News::Drawn(Box::new(answer))),
            Ok(None) => continue,
            Err(failure) => tell.tell(News::Failed(Some(request.number), failure.to_string())),
        }
        // Defects come after the first picture.
        if defects.get().is_none() {
            let _ = defects.set(Defects::of(&opened.source.caster, opened.own_faces()));
            tell.tell(News::Defects(defects.clone()));
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use umbrage::testing::shapes;
    use umbrage::write::{Layer, Model, write};

    use super::*;
    use crate::cli::window::state::{OwnLamp, State};

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        source: SourceArgs,
        #[command(flatten)]
        view: ViewArgs,
    }

    /// A folder with a cube and a hole, and a worker that has opened the cube.
    fn started() -> (tempfile::TempDir, Worker, Facts) {
        let folder = tempfile::tempdir().unwrap();
        for (name, mesh) in [("cube.obj", shapes::cube()), ("open.obj", shapes::open_cube())] {
            write(&Model { layers: vec![Layer::from(&mesh)] }, folder.path().join(name)).unwrap();
        }
        std::fs::write(folder.path().join("none.obj"), "no mesh").unwrap();
        let file = folder.path().join("cube.obj");
        let Line { source, view } = Line::parse_from(["view".into(), file.clone().into_os_string()]);
        let opener = Opener { source, view, size: Size::new(32, 24).unwrap(), ground: false };
        let opened = opener.open(file).unwrap();
        let facts = opened.facts().clone();
        (folder, Worker::start(opener, opened, None, || {}), facts)
    }

    fn request(facts: &Facts, number: u64) -> Request {
        let own = |lamp: &Lamp| OwnLamp { lamp: lamp.clone(), technique: None, is_on: true };
        let lamps = facts.lamps.iter().map(own).collect();
        let mut state = State::new(facts.bounds, facts.up, &facts.camera, lamps);
        let request = state.next(Size::new(32, 24).unwrap(), false, true).unwrap();
        Request { number, ..request }
    }

    /// News until one is wanted.
    fn wait<T>(worker: &Worker, wanted: impl Fn(News) -> Option<T>) -> T {
        loop {
            let news = worker.news.recv().expect("the thread lives");
            if let Some(found) = wanted(news) {
                return found;
            }
        }
    }

    #[test]
    fn worker_draws_opens_another_file_and_keeps_the_scene_where_there_is_none() {
        let (folder, worker, facts) = started();
        worker.draw(request(&facts, 7));
        let drawn = |news: News| match news {
            News::Drawn(answer) => Some(answer.request.number),
            _ => None,
        };
        assert_eq!(wait(&worker, drawn), 7);
        let sound = |news: News| match news {
            News::Defects(defects) => Some(defects.get().unwrap().is_sound),
            _ => None,
        };
        assert!(wait(&worker, sound));

        worker.open(folder.path().join("none.obj"));
        let failed = |news: News| match news {
            News::Failed(None, line) => Some(line),
            News::Opened(_) => panic!("it is no mesh"),
            _ => None,
        };
        assert!(wait(&worker, failed).contains("none.obj"));
        worker.draw(request(&facts, 8));
        assert_eq!(wait(&worker, drawn), 8);

        worker.open(folder.path().join("open.obj"));
        let opened = |news: News| match news {
            News::Opened(facts) => Some(facts),
            _ => None,
        };
        let other = wait(&worker, opened);
        assert!(other.file.ends_with("open.obj") && other.faces == 10);
        worker.draw(request(&other, 1));
        assert!(!wait(&worker, sound));
    }

    #[test]
    fn worker_ends_when_it_is_dropped_whatever_was_asked() {
        let (_folder, worker, facts) = started();
        for number in 1..20 {
            worker.draw(request(&facts, number));
        }
        let shared = worker.shared.clone();
        drop(worker);
        assert_eq!(Arc::strong_count(&shared), 1, "the thread has let go");
    }

    /// Of requests that come faster than pictures the last one is drawn.
    #[test]
    fn worker_draws_the_newest_request() {
        let (_folder, worker, facts) = started();
        for number in 1..=50 {
            worker.draw(request(&facts, number));
        }
        let last = |news: News| match news {
            News::Drawn(answer) if answer.request.number == 50 => Some(()),
            _ => None,
        };
        wait(&worker, last);
    }
}
