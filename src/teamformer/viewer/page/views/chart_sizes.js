// Pixels of the Gantt chart that its parts share.

export const NAME_WIDTH = 96;
export const SHARE_WIDTH = 54;
export const AXIS_HEIGHT = 24;
