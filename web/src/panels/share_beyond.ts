// Letting other computers reach the session: what it means is said before it is done.
import type { Api } from "../protocol/api";
import type { Share } from "../protocol/messages";
import { button, h } from "../ui/dom";
import { qrCode } from "../ui/qr";

export function shareBeyond(api: Api, say: (sentence: string, kind: "done" | "error") => void): HTMLElement {
  const box = h("section", { class: "beyond", "aria-live": "polite" });
  const attempt = async (act: () => Promise<Share>): Promise<void> => {
    try {
      show(await act());
    } catch (error) {
      say(error instanceof Error ? error.message : String(error), "error");
    }
  };
  const show = (now: Share): void => box.replaceChildren(h("h3", {}, "Beyond this computer"), ...(now.shared ? open(now.shared) : shut(now.addresses)));

  const shut = (addresses: string[]): HTMLElement[] => {
    if (addresses.length === 0) return [h("p", { class: "hint" }, "This computer has no address that others could reach. Join a network first.")];
    const address = h("select", { "aria-label": "Address of this computer" }, ...addresses.map((a) => h("option", { value: a }, a)));
    const port = h("input", { type: "number", min: 0, max: 65535, placeholder: "any", "aria-label": "Port" });
    const name = h("input", { type: "text", maxlength: 253, placeholder: "the address", "aria-label": "Name of this computer" });
    const certificate = h("input", { type: "file", accept: ".pem,.crt,.cer", "aria-label": "Certificate (PEM)", onchange: () => tell() });
    const key = h("input", { type: "file", accept: ".pem,.key", "aria-label": "Private key (PEM)", onchange: () => tell() });
    const means = h("p", { class: "hint" });
    const tell = (): void => {
      means.textContent = certificate.files?.length || key.files?.length
        ? "Encrypted with your certificate. A browser that does not know its issuer warns first. The key stays in the memory of the program."
        : "Not encrypted: whoever listens in this network can read along and take the links. Do so in a network that you trust, or give a certificate.";
    };
    tell();
    const text = async (input: HTMLInputElement): Promise<string | undefined> => input.files?.[0]?.text();
    return [
      h("p", { class: "hint" }, "Off: only this computer reaches the session. If you share it, everybody in the network of the address who has a link gets in: with the link for viewers to watch, with the other one to change."),
      h("div", { class: "row wrap" }, h("label", {}, "Address ", address), h("label", {}, "Port ", port)),
      h("details", {}, h("summary", {}, "With a certificate (TLS)"), h("div", { class: "beyond-tls" }, h("label", {}, "Certificate ", certificate), h("label", {}, "Private key ", key), h("label", {}, "Name in it ", name))),
      means,
      button("Share in the network", { icon: "share", class: "primary", onclick: () => void attempt(async () => api.share({
        address: address.value, port: Number(port.value) || 0, ...(name.value.trim() === "" ? {} : { name: name.value.trim() }),
        ...(certificate.files?.length ? { certificate: (await text(certificate)) ?? "" } : {}), ...(key.files?.length ? { key: (await text(key)) ?? "" } : {}),
      })) }),
    ];
  };
  const open = (shared: NonNullable<Share["shared"]>): HTMLElement[] => {
    const link = (title: string, url: string): HTMLElement => {
      const field = h("input", { type: "text", readonly: true, value: url, "aria-label": title, onfocus: () => field.select() });
      return field;
    };
    return [
      h("p", {}, h("b", {}, `Shared at ${shared.host}`), shared.encrypted ? ", encrypted." : ", not encrypted: a network that you trust."),
      h("p", { class: "hint" }, "Scan it with a phone in the same network to watch. A firewall of this computer may have to let the port through."),
      qrCode(shared.viewer_url, "QR code of the link for viewers"),
      link("Link for viewers in the network", shared.viewer_url),
      h("details", {}, h("summary", {}, "Link for controllers"), link("Link for controllers in the network", shared.controller_url)),
      button("Stop sharing", { icon: "close", onclick: () => void attempt(() => api.unshare()) }),
    ];
  };
  void attempt(() => api.shared());
  return box;
}
