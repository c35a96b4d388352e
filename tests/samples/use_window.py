"""Uses the only window of an X display as a person would: use_window.py STEP...

    key:NAME             presses a key: G, Control_L+0
    type:TEXT            presses the keys of a text
    click:X,Y            clicks; ctrl-click:X,Y with Control held down
    drag:BUTTON,X,Y,X,Y  drags from one place to another with a mouse button: 1 left, 2 middle; shift-drag with Shift held
    save:FILE.png        saves a picture of the screen

Begins when something is drawn. After every change it waits until the screen has changed twice, because the player looks at
keys and buttons once a frame; where nothing else moves, it waits for a second.
"""
import ctypes
import sys
import time

from PIL import ImageGrab

X = ctypes.CDLL("libX11.so.6")
Window = ctypes.c_ulong
LONGEST_FRAME = 1.0  # seconds; on slow machines something on the screen must change, or frames are missed


class Event(ctypes.Structure):
    """XKeyEvent and XButtonEvent: `code` is a key or a button."""
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p),
                ("window", Window), ("root", Window), ("subwindow", Window), ("time", ctypes.c_ulong), ("x", ctypes.c_int),
                ("y", ctypes.c_int), ("x_root", ctypes.c_int), ("y_root", ctypes.c_int), ("state", ctypes.c_uint),
                ("code", ctypes.c_uint), ("same_screen", ctypes.c_int), ("pad", ctypes.c_long * 12)]


X.XOpenDisplay.restype = ctypes.c_void_p
X.XDefaultRootWindow.restype, X.XDefaultRootWindow.argtypes = Window, [ctypes.c_void_p]
X.XKeysymToKeycode.restype, X.XKeysymToKeycode.argtypes = ctypes.c_ubyte, [ctypes.c_void_p, ctypes.c_ulong]
X.XStringToKeysym.restype = ctypes.c_ulong
X.XQueryTree.argtypes = [ctypes.c_void_p, Window] + 4 * [ctypes.c_void_p]
X.XSendEvent.argtypes = [ctypes.c_void_p, Window, ctypes.c_int, ctypes.c_long, ctypes.c_void_p]
X.XWarpPointer.argtypes = [ctypes.c_void_p, Window, Window] + 6 * [ctypes.c_int]
X.XFlush.argtypes = [ctypes.c_void_p]
KEY_PRESS, KEY_RELEASE, BUTTON_PRESS, BUTTON_RELEASE = 2, 3, 4, 5
display = ctypes.c_void_p(X.XOpenDisplay(None))
root = X.XDefaultRootWindow(display)
position = [0, 0]


def windows():
    parent, other, found, count = Window(), Window(), ctypes.POINTER(Window)(), ctypes.c_uint()
    X.XQueryTree(display, root, ctypes.byref(other), ctypes.byref(parent), ctypes.byref(found), ctypes.byref(count))
    return [found[i] for i in range(count.value)]


def screen():
    return ImageGrab.grab(xdisplay="")


def wait_for_drawing(seconds=60):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if len(screen().getcolors(1 << 24)) > 500:  # not one colour
            return
        time.sleep(0.1)
    sys.exit("nothing is drawn")


def wait_for_frames():
    for _ in range(2):
        before, end = screen().tobytes(), time.monotonic() + LONGEST_FRAME
        while time.monotonic() < end and screen().tobytes() == before:
            time.sleep(0.02)


def send(kind, code):
    """The player knows what is held down from earlier events, so `state` may stay 0."""
    for window in windows():
        event = Event(type=kind, display=display, window=window, root=root, code=code, same_screen=1, x=position[0],
                      y=position[1], x_root=position[0], y_root=position[1])
        X.XSendEvent(display, window, 1, {KEY_PRESS: 1, KEY_RELEASE: 2, BUTTON_PRESS: 4, BUTTON_RELEASE: 8}[kind],
                     ctypes.byref(event))
    X.XFlush(display)
    wait_for_frames()


def code_of(name):
    return X.XKeysymToKeycode(display, X.XStringToKeysym(name.encode()))


def move(x, y):
    position[:] = x, y
    X.XWarpPointer(display, 0, root, 0, 0, 0, 0, x, y)
    X.XFlush(display)
    wait_for_frames()


def press(names):
    codes = [code_of(name) for name in names]
    for code in codes:
        send(KEY_PRESS, code)
    for code in reversed(codes):
        send(KEY_RELEASE, code)


def drag(button, *places):
    move(*places[:2])
    send(BUTTON_PRESS, button)
    for i in range(2, len(places), 2):
        move(*places[i:i + 2])
    send(BUTTON_RELEASE, button)


def holding(name, call):
    send(KEY_PRESS, code_of(name))
    call()
    send(KEY_RELEASE, code_of(name))


def do(step):
    action, _, argument = step.partition(":")
    if action == "key":
        press(argument.split("+"))
    elif action == "type":
        for letter in argument:
            press([{".": "period", "\n": "Return"}.get(letter, letter)])
    elif action == "save":
        wait_for_frames()
        screen().save(argument)
    else:
        held, _, action = action.rpartition("-")
        numbers = [int(number) for number in argument.split(",")]
        call = {"click": lambda: drag(1, *numbers), "drag": lambda: drag(*numbers)}[action]
        holding({"ctrl": "Control_L", "shift": "Shift_L"}[held], call) if held else call()


wait_for_drawing()
for one in sys.argv[1:]:
    do(one)
