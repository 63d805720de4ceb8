// A virtual AGV of vda-5050-lib that also knows the instant action `serve`.
// node virtual_agv.js BROKER INTERFACE MANUFACTURER SERIAL X Y THETA FAILURES
const { AgvController, VirtualAgvAdapter, ActionStatus } = require("vda-5050-lib");
const [broker, interfaceName, manufacturer, serialNumber, ...numbers] = process.argv.slice(2);
const [x, y, theta, failures] = numbers.map(Number);
let failuresLeft = failures; // services that fail before one succeeds

class Serving extends VirtualAgvAdapter {
  get actionDefinitions() {
    const serve = {
      actionType: "serve",
      actionScopes: "instant",
      actionExecutable: () => (failuresLeft-- > 0 ? "the gripper is jammed" : ""),
      transitions: {
        ON_INIT: { next: ActionStatus.Running },
        ON_CANCEL: {},
        [ActionStatus.Running]: { durationTime: ["duration", 1], next: ActionStatus.Finished },
        [ActionStatus.Finished]: { resultDescription: () => "served" },
        [ActionStatus.Failed]: { errorDescription: () => "failed" },
      },
    };
    return [...super.actionDefinitions, serve];
  }
}

const agv = { manufacturer, serialNumber };
const client = {
  interfaceName,
  transport: { brokerUrl: broker },
  vdaVersion: "2.0.0",
};
const controller = { agvAdapterType: Serving, publishStateInterval: 1000 };
const adapter = {
  initialPosition: { mapId: "map", x, y, theta, lastNodeId: "start" },
  vehicleSpeed: 2,
};
new AgvController(agv, client, controller, adapter).start().then(
  () => console.log("started"),
  (error) => { console.error(error); process.exit(1); },
);
