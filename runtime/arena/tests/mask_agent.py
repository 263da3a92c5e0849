"""A mask agent, written as existing clients are: an orchestrator that talks to the simulator, a builder that turns a
model's actions into requests, and an agent that knows objects by masks in pictures alone. Standard library only.

    mask_agent.py PORT MISSION.json OTHER_MISSION.json

plays the first mission to its goals, launches the other on the same connection, loses the connection, comes back, and
prints what came of it as JSON.
"""

import base64
import json
import socket
import struct
import sys
import zlib

SIDE = 300


def decode_png(text):
    """The pixels of a base64 PNG, (red, green, blue) each, row by row."""
    data = base64.b64decode(text)
    assert data[:8] == b"\x89PNG\r\n\x1a\n", "not a PNG"
    at, packed, header = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + length]
        assert zlib.crc32(kind + body) == struct.unpack(">I", data[at + 8 + length : at + 12 + length])[0]
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    width, height, depth, color_type, _, _, interlaced = header
    assert (width, height, depth, interlaced) == (SIDE, SIDE, 8, 0), header
    step = {2: 3, 6: 4}[color_type]
    raw, stride, before, pixels = zlib.decompress(packed), width * step, bytes(width * step), []
    for row in range(height):
        kind = raw[row * (stride + 1)]
        line = bytearray(raw[row * (stride + 1) + 1 : (row + 1) * (stride + 1)])
        if kind == 1:
            for i in range(step, stride):
                line[i] = (line[i] + line[i - step]) & 255
        elif kind == 2:
            line = bytearray((a + b) & 255 for a, b in zip(line, before))
        elif kind == 3:
            for i in range(stride):
                left = line[i - step] if i >= step else 0
                line[i] = (line[i] + (left + before[i]) // 2) & 255
        elif kind == 4:
            for i in range(stride):
                left, corner = (line[i - step], before[i - step]) if i >= step else (0, 0)
                up = before[i]
                guess = left + up - corner
                off = abs(guess - left), abs(guess - up), abs(guess - corner)
                line[i] = (line[i] + (left if off[0] <= off[1] and off[0] <= off[2] else up if off[1] <= off[2] else corner)) & 255
        before = bytes(line)
        pixels.extend((line[i], line[i + 1], line[i + 2]) for i in range(0, stride, step))
    return pixels


class Orchestrator:
    """The connection to the simulator, and the state of the game by its last reply."""

    def __init__(self, port):
        self.port, self.socket, self.response, self.segmentation = port, None, None, []
        self.last_action = None
        self.builder = RequestBuilder(self)
        self.connect()

    def connect(self):
        self.socket = socket.create_connection(("127.0.0.1", self.port), timeout=120)

    def send(self, message):
        data = json.dumps(message).encode("utf-8")
        self.socket.sendall(len(data).to_bytes(4, byteorder="little") + data)

    def receive(self, count):
        data = b""
        while len(data) < count:
            piece = self.socket.recv(count - len(data))
            if not piece:
                raise ConnectionError("the simulator has closed the connection")
            data += piece
        return data

    def is_connected(self):
        try:
            self.socket.sendall(b"")
            self.socket.sendall((0).to_bytes(4, byteorder="little"))
            return True
        except OSError:
            return False

    def interact(self, commands):
        if not self.is_connected():
            self.connect()
        self.send(commands)
        length = int.from_bytes(self.receive(4), byteorder="little")
        self.response, self.segmentation = json.loads(self.receive(length)), []
        return self.response

    def launch_game(self, cdf):
        if not self.is_connected():
            self.connect()
        self.send(cdf)
        dummy = [{"id": "1", "type": "Rotate", "rotate": {"direction": "Right", "magnitude": 0}}]
        for _ in range(10):
            if self.execute(dummy):
                return
        raise RuntimeError("the dummy action failed: " + self.response["lastActionSuccess"])

    def execute(self, actions):
        """Does actions as a model emits them; says whether they succeeded."""
        commands = [self.builder.command(action) for action in actions]
        response = self.interact(commands)
        last = json.loads(response["lastAction"])
        self.last_action = actions[last["commandNum"]]["id"]
        assert last["commandType"] == commands[last["commandNum"]]["commandType"], last
        return response["lastActionSuccess"] in ("ActionSuccessful", "AlternateNavigationUsed")

    def segmentation_images(self):
        if not self.segmentation:
            self.segmentation = [decode_png(image) for image in self.response["instanceSegmentationImage"]]
        return self.segmentation

    def object_by_color(self):
        def color(record):
            channels = record["instanceSegmentationColor"]
            return channels["r"], channels["g"], channels["b"]

        return {color(record): record for record in self.response["objects"]}

    def goals(self):
        return [goal["isFinished"] for goal in self.response["challengeProgress"]["ChallengeGoals"]]


class RequestBuilder:
    """Turns actions into the simulator's commands."""

    VERBS = ("Open", "Close", "Break", "Scan", "Pour", "Toggle", "Fill", "Clean", "Examine")

    def __init__(self, orchestrator):
        self.orchestrator = orchestrator

    def object_id(self, target):
        """The object that most of a mask lies on."""
        image = self.orchestrator.segmentation_images()[target.get("colorImageIndex", 0)]
        known, counts = self.orchestrator.object_by_color(), {}
        for start, length in target["mask"]:
            for place in range(start, start + length):
                record = known.get(image[place])
                if record:
                    counts[record["objectID"]] = counts.get(record["objectID"], 0) + 1
        return max(counts, key=counts.get) if counts else None

    def command(self, action):
        kind = action["type"]
        fields = action[kind.lower()]
        if kind == "Rotate":
            sign = 1 if fields["direction"] == "Right" else -1
            return {"commandType": "Rotate", "magnitude": sign * fields["magnitude"], "rotationSpeed": 45}
        if kind == "Look":
            if fields["direction"] == "Around":
                around = {"fieldOfView": fields["magnitude"], "shouldRotate": False}
                return {"commandType": "LookAround", "lookAroundCommand": around}
            return {"commandType": "Look" + fields["direction"], "panAndLookCommand": {"magnitude": fields["magnitude"]}}
        if kind == "Goto":
            target = fields["object"]
            if "officeRoom" in target:
                return {"commandType": "GoTo", "goToCommand": {"officeRoom": target["officeRoom"]}}
            return {"commandType": "GoTo", "goToCommand": {"instanceIdOfObject": self.object_id(target)}}
        object_id = self.object_id(fields["object"])
        if kind in ("Pickup", "Place"):
            command = {"Pickup": "PickUp", "Place": "Place"}[kind]
            return {"commandType": command, "pickUpOrPlaceCommand": {"destinationObjectID": object_id}}
        assert kind in self.VERBS, kind
        interact = {"sourceObjectID": "TAM_1", "destinationObjectID": object_id, "verb": kind.upper()}
        return {"commandType": "Interact", "interactCommand": interact}


class MaskAgent:
    """Finds things by what the pictures show, and acts on their masks. A detector stands in for a model that sees."""

    FEWEST_PIXELS = 12

    def __init__(self, orchestrator):
        self.orchestrator, self.actions, self.seen = orchestrator, 0, 0

    def do(self, kind, **fields):
        self.actions += 1
        done = self.orchestrator.execute([{"id": str(self.actions), "type": kind, kind.lower(): fields}])
        if not done:
            response = self.orchestrator.response
            failed = self.orchestrator.last_action
            raise RuntimeError(f"{failed}: {kind} {fields}: {response['lastActionSuccess']}: {response['message']}")

    def detect(self, kind):
        """The largest thing of a class in the last pictures, as an action's object; None if there is none."""
        known, best = self.orchestrator.object_by_color(), None
        for index, image in enumerate(self.orchestrator.segmentation_images()):
            places = {}
            for place, color in enumerate(image):
                places.setdefault(color, []).append(place)
            for color, found in places.items():
                record = known.get(color)
                if record and record["objectType"] == kind and len(found) >= self.FEWEST_PIXELS:
                    if best is None or len(found) > best[0]:
                        best = len(found), index, found
        if best is None:
            return None
        self.seen += 1
        return {"colorImageIndex": best[1], "mask": runs(best[2])}

    def find(self, kind):
        """The same, looking around and up and down for it."""
        found = self.detect(kind)
        looks = [("Around", 100), ("Down", 30), ("Around", 100), ("Up", 60), ("Around", 100), ("Down", 30)]
        for direction, degrees in looks:
            if found:
                break
            self.do("Look", direction=direction, magnitude=degrees)
            found = self.detect(kind)
        if not found:
            raise RuntimeError(f"there is no {kind} to be seen")
        return found

    def go_to(self, kind):
        self.do("Goto", object=self.find(kind))

    def act(self, verb, kind):
        self.do(verb, object=self.find(kind))


def runs(places):
    """Places in order as [start, length] runs."""
    found = []
    for place in places:
        if found and place == found[-1][0] + found[-1][1]:
            found[-1][1] += 1
        else:
            found.append([place, 1])
    return found


def serve_coffee(agent):
    agent.do("Look", direction="Around", magnitude=100)
    for verb, kind in [
        ("Goto", "CoffeeMug_Boss"),
        ("Pickup", "CoffeeMug_Boss"),
        ("Goto", "Microwave_01"),
        ("Open", "Microwave_01"),
        ("Place", "Microwave_01"),
        ("Close", "Microwave_01"),
        ("Toggle", "Microwave_01"),
        ("Open", "Microwave_01"),
        ("Pickup", "CoffeeMug_Boss"),
    ]:
        agent.go_to(kind) if verb == "Goto" else agent.act(verb, kind)
    agent.do("Goto", object={"officeRoom": "SmallOffice"})
    agent.go_to("ManagerDesk")
    agent.act("Place", "ManagerDesk")


def main(port, mission, other):
    result = {}
    orchestrator = Orchestrator(int(port))
    orchestrator.launch_game(mission)
    agent = MaskAgent(orchestrator)
    serve_coffee(agent)
    result["goals"] = orchestrator.goals()
    result["actions"], result["masks"] = agent.actions, agent.seen
    # A mask with no object on it.
    orchestrator.interact([{"commandType": "PickUp", "pickUpOrPlaceCommand": {"destinationObjectID": None}}])
    result["nothing"] = orchestrator.response["lastActionSuccess"]
    # The third of five actions fails: the reply says which.
    turns = [{"id": str(n), "type": "Rotate", "rotate": {"direction": "Right", "magnitude": 0}} for n in range(5)]
    turns[2] = {"id": "two", "type": "Goto", "goto": {"object": {"officeRoom": "Attic"}}}
    result["third"] = [orchestrator.execute(turns), orchestrator.last_action]
    # The same connection, another game.
    orchestrator.launch_game(other)
    result["relaunched"] = orchestrator.goals()
    orchestrator.execute([{"id": "1", "type": "Goto", "goto": {"object": {"officeRoom": "Lab1"}}}])
    before = orchestrator.response["objects"][0]
    # The connection is lost in the middle of a message; the game is not.
    orchestrator.socket.sendall((500).to_bytes(4, byteorder="little") + b"[{")
    orchestrator.socket.close()
    orchestrator.execute([{"id": "1", "type": "Rotate", "rotate": {"direction": "Right", "magnitude": 0}}])
    result["carried_on"] = orchestrator.response["objects"][0]["position"] == before["position"]
    orchestrator.launch_game(mission)
    result["again"] = orchestrator.goals()
    # A second client takes over from the first.
    orchestrator.socket.close()
    second = Orchestrator(int(port))
    second.launch_game(mission)
    result["second"] = second.response["lastActionSuccess"]
    print(json.dumps(result))


if __name__ == "__main__":
    port, mission, other = sys.argv[1:]
    with open(mission, encoding="utf-8") as first, open(other, encoding="utf-8") as second:
        main(port, json.load(first), json.load(second))
