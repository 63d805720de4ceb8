// The types of what the modules of the page hand to one another; `make types` checks them.

type Canvas2D = CanvasRenderingContext2D;
type Place = [number, number]; // in cells, or squares of a plane
type Count = [number, number]; // a capability and how much of it
type Counts = Count[];
type Spot = { x: number; y: number; r: number }; // a disc on the screen, in pixels
type Box = { x: number; y: number; half: number }; // a square on the screen, in pixels

// What the server or a file holds, as JSON; the record is checked before it is read.

type MissionTree = any; // as docs/reference/mission.md has it
type Message = any; // of the server of a live mission
type StepTree = Record<string, any[]>;
type RecordTree = {
  mission: MissionTree;
  truth?: any;
  foresight?: string;
  method: string;
  seed: number;
  orders: [number, number[]][];
  plans?: [number, [string[], number[][]]][];
  start: [number, number[], number, number][];
  steps: StepTree[];
  end: End;
  lower_bound: number | null;
  told?: any;
};
type End = {
  status: string;
  makespan: number | null;
  blocked_tasks: string[];
  steps?: number;
  cost?: number | null; // in continuous time, like the next one
  broken_links?: [string, string][];
};

// What a record is read into.

interface World {
  width: number;
  height: number;
  rows: string[];
  isBlocked(x: number, y: number): boolean;
  used: { left: number; low: number; width: number; height: number };
  yIsUp: boolean;
  fields: Map<number, Int32Array>; // distances, by their goal
  image?: { canvas: HTMLCanvasElement; colour: string }; // of the walls
  isPlane: boolean; // ways are straight
  isTimed: boolean; // steps have a length: on planes, and in continuous time
  secondsUnit: string; // " s" where that is in seconds
  roads?: Roads;
  square: number; // metres a square; 1 on grids
  arrival: number; // from how far a place counts as reached, in squares; 0 on grids
  stepSeconds: number; // 1 on grids, whose steps have no length; how long a tick is in continuous time
}

interface Roads {
  names: string[];
  places: Place[];
  pairs: [number, number][]; // of places with a road between
}

interface Robot {
  name: string;
  at: Place;
  can: Counts;
  said: any; // as the file has it
  flies: boolean;
  delay: number; // of how many steps it stands still in
}

interface Site {
  at: Place;
  isUp?: boolean; // a load that is being carried: `at` is then where it is brought
  mates: number[]; // all tasks in exactly this place
}

interface Task extends Site {
  name: string;
  said: any; // as the file has it
  around: Place;
  within: number;
  first: Place; // where it is believed to be at first
  needs: Counts;
  sure: Counts;
  believed: Counts;
  mayNeed: Counts; // with the probability that one more is needed
  lasts: [number, number] | null;
  duration: number;
  opens: number;
  appears: number;
  cancelled: number;
  after: number[];
  to: Place | null;
  unload: number;
  due: number;
  weight: number;
}

interface Mission {
  name: string;
  capabilities: string[];
  world: World;
  robots: Robot[];
  tasks: Task[];
  chargers: { at: Place; room?: number }[];
  zones: { name: string; area: Place[] | null; room: number; tasks: number[]; loads: number[] }[];
  tasksAt: Map<string, number[]>; // by cell
  doTasksMove: boolean;
  sensingRadius: number;
  cost: Record<string, number> | null;
}

interface State {
  team: Int32Array; // by robot, the slot of its team
  x: Float64Array; // by slot
  y: Float64Array;
  task: Int32Array;
}

interface Absence {
  from: number;
  to: number;
  place: Place;
}

// What happened in a step; what else it has depends on its kind, see `record/words.js`.
interface HistoryEvent {
  step: number;
  when?: number; // in continuous time, exactly
  kind: string;
  [field: string]: any;
}

interface TrialHistory {
  record: RecordTree;
  mission: Mission;
  last: number; // the number of steps
  end: End;
  lowerBound: number | null;
  hasMessages: boolean;
  keyframes: State[];
  latest: { step: number; state: State } | null; // the state asked for last
  events: HistoryEvent[];
  told: Told;
  doneAt: number[];
  overAt: number[]; // the step in which a task is done, called off or missed
  missed: Map<number, string>; // why tasks are missed
  doers: number[][]; // the robots of the team that did a task
  shownAt: number[];
  foundAt: number[];
  moves: { step: number; task: number; at: Place; isUp?: boolean }[];
  absences: Absence[][]; // by robot
  headings: number[];
  leaving: Map<number, Absence>;
  at(step: number): State;
  sitesAfter(count: number): Site[];
  grow(change: any, told?: any, end?: End): void; // in continuous time what a message says
  curves?: { made: number; open: number[]; idle: number[]; way: number[] };
  expected?: (number | null)[];
  isContinuous?: boolean; // steps are then ticks, and times have fractions
  until?: number; // when the record ends, within its last tick
  trail?: number; // steps
  tracks?: import("./record/tracks.js").Track[];
}

// What a team did for a task, from the end of a step to that of another; `to` is open while it goes on.
interface Service {
  task: number;
  doing: string;
  from: number;
  to: number;
  began: number[]; // robots
  slot: number | null; // of the team that these are, if they are one
  ended: number[];
}

interface Told {
  rows: Service[];
  services: Service[][]; // by task
  phases: any[][]; // by robot, as in the record
  texts: string[];
  path: Stretch[];
  charge: number[][][]; // by robot: since when a battery is how full, and by how much that changes in a tick
  runs: Map<number, { last: number; runs: Run[] }>; // worked out of the phases
}

interface Team {
  slot: number;
  robots: number[];
  x: number;
  y: number;
  counts: Map<number, number>;
  assigned: number;
  goal: number; // the task whose colour the ring may take: the one served, just done or headed for
  isMet: boolean;
  missing: Counts;
  service: Service | null;
  justDone: number;
  activity: string;
  carries: boolean;
  site: Site | null; // where its task is believed to be
  ahead: { places: Place[]; until: number } | null; // its way in continuous time, and when it is there
}

interface Scene {
  step: number;
  state: State;
  teams: Map<number, Team>;
  assignedTo: Map<number, Team[]>;
}

// What is shown.

type Run = { phase: string; task: number; from: number; to: number };
type Stretch = { from: number; to: number; doing: string; robot: number; task: number };
type Selected = { robot?: number; task?: number; cap?: number; place?: Place };
type Group = { x: number; y: number; r: number; teams: Team[]; count: number; column: number; row: number };
type Thing = { robot?: number; task?: number; group?: Group };
type Theme = Record<string, string>;
type Colour = { fill: string; ink: string };
type Options = Record<string, any>;

interface Trial {
  record: RecordTree;
  history: TrialHistory;
  colours: Colour[];
  labels: string[];
  sceneAt(step: number): Scene;
}

// Where everything is drawn after a step, in cells.
interface Places {
  x: Float64Array; // by robot
  y: Float64Array;
  r: Float64Array;
  cells: Map<string, number>; // by cell, the radius of all that is in it
}

// All that the drawing functions need to know of a moment.
interface View {
  ctx: Canvas2D;
  width: number;
  height: number;
  camera: Camera;
  history: TrialHistory;
  scene: Scene;
  sceneAfter: Scene;
  detail: string;
  part: number;
  sharpness: number;
  images: Map<string, HTMLCanvasElement>;
  mission: Mission;
  sites: Site[];
  theme: Theme;
  isDark: boolean;
  colours: Colour[];
  labels: string[];
  options: Options;
  selection: Selected;
  selectedTeam: Team | null;
  places: Places;
  placesAfter: Places;
  blended: Places;
  groups: Group[]; // and what else was drawn, with its places
  names: any[];
  legend: any[];
  mostInSquare: number; // robots, where they are drawn as densities
}

// What the tables show.
type Cell = { text: string; sort: number | string | null; isAhead?: boolean; isBad?: boolean; whole?: () => string };
type Column = { name: string; of(moment: Moment, item: number): Cell; isShown?: (mission: Mission) => boolean };
interface Moment {
  history: TrialHistory;
  mission: Mission;
  scene: Scene;
  step: number;
  plan: Map<number, number[]> | null; // coalitions by task
  deeds: { task: number; step: number }[][];
  next: Map<number, number>;
}

// What the server says that an operator of a fleet should know.
type Alert = {
  key: string;
  what: string;
  why: string;
  do: string;
  since: number | null;
  seconds: number;
  begun: number;
  is_acknowledged: boolean;
};

// How a live mission stands, as the server says.
type LiveState = {
  incidents: [number, string][];
  watchers: number;
  alerts: Alert[];
  planning?: string;
  hasEditor?: boolean;
  undoTo?: number;
  savedAt?: number;
  id?: string;
  isFleet?: boolean;
  isHeard?: boolean;
  isOver?: boolean;
};

type App = import("./app.js").App;
type LiveApp = import("./live/app.js").LiveApp;
type EditorApp = import("./editor/app.js").EditorApp;
type Rows = import("./panel/rows.js").Rows;
type Companion = import("./compared/companion.js").Companion;
type Shown = App | Companion;
type Player = import("./player.js").Player;
type Camera = import("./draw/camera.js").Camera;
type TrialMap = import("./draw/map.js").TrialMap;
type Gantt = import("./views/gantt.js").Gantt;

// Parts of `page.html` that are more than any element.
interface Parts {
  "help-text": HTMLDialogElement;
  menu: HTMLDetailsElement;
  map: HTMLCanvasElement;
  gantt: HTMLCanvasElement;
  plots: HTMLCanvasElement;
  marks: HTMLCanvasElement;
  scrub: HTMLInputElement;
  filter: HTMLInputElement;
  speed: HTMLSelectElement;
  rings: HTMLSelectElement;
  bars: HTMLSelectElement;
}

declare const FILE_KEYS: Record<"robots" | "tasks", { name: string; label: string; help: string; field: string; isInDetails: boolean }[]>;

interface Window {
  teamformer: object; // for tests and the curious
}
